// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// scanlock-align --method 4dof..., from outside.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "../global/scenes.hpp"
#include "align_samples.hpp"
#include "io/cloud_file.hpp"
#include "io/trajectory.hpp"

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
    write_transform(truth, pose);
  }
};

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

TEST_CASE("align chains clouds without a start, and stops at a pair that is not certain") {
  const Yards yards;
  const std::string poses = yards.folder / "poses.tum";
  const Result chain = run(yards.folder, {"scanlock-align", yards.target, yards.source, yards.target,
                                          "--chain", "--poses", poses, "--json"});
  REQUIRE(chain.code == 0);
  CHECK(says(chain.output, "\"method\":\"4dof+robust-icp\""));
  CHECK(says(chain.output, "\"verdict\":\"certain\""));
  const Trajectory trajectory = read_tum(poses);
  REQUIRE(trajectory.size() == 3);
  const Pose error = trajectory[1].pose.inverse() * level_pose(2.2, 3, -2, 0.1);
  CHECK(error.translation().norm() < 0.05);
  CHECK(so3_log(error.linear()).norm() < 0.0035);
  CHECK(trajectory[2].pose.translation().norm() < 0.05);

  std::vector<std::string> lost = {"scanlock-align", yards.target, yards.source, yards.elsewhere, "--chain"};
  const Result stopped = run(yards.folder, lost);
  CHECK(stopped.code == 1);
  CHECK(stopped.output.empty());
  CHECK(says(stopped.errors, yards.elsewhere + " to " + yards.source));
  lost.push_back("--json");
  const Result went_on = run(yards.folder, lost);
  CHECK(went_on.code == 0);
  CHECK(number(went_on.output, "clouds") == 3);
  CHECK(says(went_on.errors, yards.elsewhere + " to " + yards.source));
}
