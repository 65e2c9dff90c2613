// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// scanlock-align --method 4dof..., from outside.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "../global/scenes.hpp"
#include "io/cloud_file.hpp"
#include "process.hpp"

using namespace scanlock;
using namespace scanlock::test;

namespace {

struct Yards {
  TemporaryFolder folder;
  std::string source = folder / "source.pcd", target = folder / "target.pcd",
              elsewhere = folder / "other.pcd", truth = folder / "truth.txt";
  Yards() {
    const Pose pose = level_pose(2.2, 3, -2, 0.1);
    write_cloud(source, moved(yard(1, 21), pose.inverse()));
    write_cloud(target, yard(1, 20));
    write_cloud(elsewhere, yard(6, 20));
    std::string text;
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) text += std::to_string(pose.matrix()(row, column)) + " ";
      text += "\n";
    }
    write_file(truth, text);
  }
};

double number(const std::string& json, const std::string& key) {
  const std::size_t at = json.find("\"" + key + "\":");
  REQUIRE(at != std::string::npos);
  return std::stod(json.substr(at + key.size() + 3));
}

bool says(const std::string& json, const std::string& what) {
  return json.find(what) != std::string::npos;
}

}  // namespace

TEST_CASE("align finds a pose without a start, and says how sure it is") {
  const Yards yards;
  for (const std::string method : {"", "4dof", "4dof+robust-icp-plane"}) {
    std::vector<std::string> arguments = {"scanlock-align", yards.source, yards.target,
                                          "--truth",        yards.truth,  "--json"};
    if (!method.empty()) arguments.insert(arguments.end(), {"--method", method});
    const Result result = run(yards.folder, arguments);
    CHECK(result.code == 0);
    CHECK(says(result.output, "\"verdict\":\"certain\""));
    CHECK(says(result.output, "\"certified\":true"));
    CHECK(number(result.output, "consensus") == number(result.output, "upper_bound"));
    CHECK(number(result.output, "runner_up_consensus") < number(result.output, "consensus"));
    CHECK(number(result.output, "matches_after_pruning") <= number(result.output, "matches"));
    for (const char* part : {"keypoints", "features", "matching", "pruning", "search"})
      CHECK(number(result.output, part) >= 0);
    CHECK(number(result.output, "rotation_error_deg") < (method == "4dof" ? 1.0 : 0.2));
    CHECK(number(result.output, "translation_error") < (method == "4dof" ? 0.3 : 0.05));
  }
}

TEST_CASE("align is not certain about clouds of different places") {
  const Yards yards;
  const Result result = run(yards.folder, {"scanlock-align", yards.source, yards.elsewhere, "--json"});
  CHECK(result.code == 0);
  CHECK_FALSE(says(result.output, "\"verdict\":\"certain\""));
}

TEST_CASE("align refuses a vertical and an epsilon that make no sense") {
  const Yards yards;
  CHECK(run(yards.folder, {"scanlock-align", yards.source, yards.target, "--up", "0,0,0"}).code == 2);
  CHECK(run(yards.folder, {"scanlock-align", yards.source, yards.target, "--epsilon", "0"}).code == 2);
  CHECK(run(yards.folder, {"scanlock-align", yards.source, yards.target, "--epsilon=-1"}).code == 2);
  CHECK(run(yards.folder, {"scanlock-align", yards.source, yards.target, "--method", "4dof+nothing"}).code ==
        2);
}
