// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <string>

#include "process.hpp"

using namespace scanlock::test;

TEST_CASE("scanlock-align solves a correspondence file") {
  const TemporaryFolder folder;
  const std::string file = folder / "matches.txt";
  // A quarter turn about z and (1, 2, 3); the last match is wrong.
  write_file(file, "# p, q\n1 0 0 1 3 3\n0 1 0 0 2 3\n2 2 1 -1 4 4\n-3 1 2 0 -1 5\n5 5 5 0 0 0\n");
  for (const bool prune : {true, false}) {
    std::vector<std::string> command = {"scanlock-align", "--correspondences", file, "--epsilon", "0.05",
                                        "--json"};
    if (!prune) command.push_back("--no-pruning");
    const Result result = run(folder, command);
    REQUIRE(result.code == 0);
    for (const char* part : {"\"method\":\"4dof\"", "\"transform\":[", "\"matches\":5", "\"consensus\":4",
                             "\"upper_bound\":4", "\"certified\":true", "\"runner_up_consensus\":",
                             "\"nodes\":", "\"matches_after_pruning\":", "\"pruning\":", "\"search\":"}) {
      CAPTURE(part);
      CHECK(result.output.find(part) != std::string::npos);
    }
  }
  std::vector<std::string> baseline = {"scanlock-align", "--correspondences", file,    "--epsilon",
                                       "0.05",           "--ransac",          "--json"};
  const Result ransac = run(folder, baseline);
  CHECK(ransac.code == 1);
  CHECK(ransac.errors ==
        "scanlock-align: not certified: the consensus is 4, its upper bound 5; --accept any accepts it\n");
  baseline.insert(baseline.end(), {"--accept", "any"});
  CHECK(run(folder, baseline).code == 0);
  for (const char* part : {"\"consensus\":4", "\"certified\":false", "\"stop_reason\":\"samples\""}) {
    CAPTURE(part);
    CHECK(ransac.output.find(part) != std::string::npos);
  }
}

TEST_CASE("scanlock-align reports the error in an invalid correspondence file") {
  const TemporaryFolder folder;
  const std::string file = folder / "matches.txt";
  const auto code = [&](const std::string& text, const std::string& epsilon) {
    write_file(file, text);
    return run(folder, {"scanlock-align", "--correspondences", file, "--epsilon", epsilon}).code;
  };
  CHECK(code("1 2 3 4 5 6\n", "0.1") == 0);
  CHECK(code("", "0.1") == 1);
  CHECK(code("1 2 3 4 5 6\n1 2 3 4 5\n", "0.1") == 1);
  CHECK(code("1 2 3 4 5 nan\n", "0.1") == 1);
  CHECK(code("1 2 3 4 5 6\n", "0") == 2);
  CHECK(code("1 2 3 4 5 6\n", "-1") == 2);
  CHECK(code("1 2 3 4 5 6\n", "nan") == 2);
}
