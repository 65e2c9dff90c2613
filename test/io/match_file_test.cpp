// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/match_file.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <stdexcept>

#include "temporary_directory.hpp"

namespace scanlock {
namespace {

struct File {
  TemporaryDirectory directory;
  std::string path = directory / "matches.txt";
  explicit File(const std::string& text) { std::ofstream(path) << text; }
};

TEST_CASE("Matches are read, comments and blank lines passed over") {
  const File file("# epsilon 0.1\n\n1 2 3 4 5 6\r\n  -1e-1\t2.5 3, 4 5 6 # the second\n7 8 9 10 11 12");
  const Matches matches = read_matches(file.path);
  REQUIRE(matches.size() == 3);
  CHECK(matches[0].p == Eigen::Vector3d(1, 2, 3));
  CHECK(matches[0].q == Eigen::Vector3d(4, 5, 6));
  CHECK(matches[1].p == Eigen::Vector3d(-0.1, 2.5, 3));
  CHECK(matches[2].q == Eigen::Vector3d(10, 11, 12));
}

TEST_CASE("A malformed line is named") {
  const std::string good = "# comment\n1 2 3 4 5 6\n";
  for (const std::string bad : {"1 2 3 4 5\n", "1 2 3 4 5 6 7\n", "1 2 x 4 5 6\n", "1 2 nan 4 5 6\n",
                                "1 2 3 4 5 inf\n", "1 2 3 4 5 1e999\n"}) {
    const File file(good + bad + good);
    CHECK_THROWS_WITH_AS(read_matches(file.path), doctest::Contains((file.path + ":3: ").c_str()),
                         std::runtime_error);
  }
}

TEST_CASE("A file without matches is an error, as is a missing one") {
  for (const std::string text : {"", "\n\n", "# nothing\n"}) {
    const File file(text);
    CHECK_THROWS_WITH_AS(read_matches(file.path), doctest::Contains(file.path.c_str()), std::runtime_error);
  }
  CHECK_THROWS_AS(read_matches("/nowhere/matches.txt"), std::runtime_error);
}

TEST_CASE("More matches than there may be are refused") {
  const File file("1 2 3 4 5 6\n1 2 3 4 5 6\n1 2 3 4 5 6\n");
  CHECK(read_matches(file.path, 3).size() == 3);
  CHECK_THROWS_WITH_AS(read_matches(file.path, 2), doctest::Contains(":3: "), std::runtime_error);
}

}  // namespace
}  // namespace scanlock
