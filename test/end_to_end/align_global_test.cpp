// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of the program scanlock-align with --method 4dof...
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "../global/scenes.hpp"
#include "align_samples.hpp"
#include "geometry/angles.hpp"
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

TEST_CASE("align without an initial pose finds the pose and reports verdict, bounds and runner-up") {
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

TEST_CASE("align prints an uncertain pose with its verdict and fails, unless --accept allows the verdict" *
          doctest::test_suite("many trials")) {
  const Yards yards;
  const std::string here = yards.folder / "here.pcd", there = yards.folder / "there.pcd";
  write_cloud(here, scanned_tunnel(1));
  write_cloud(there, scanned_tunnel(2));
  struct Case {
    std::string source, target, verdict;
    int certain, ambiguous, any;  // exit codes by the value of --accept
  };
  for (const Case& c :
       {Case{yards.source, yards.target, "certain", 0, 0, 0}, Case{here, there, "ambiguous", 1, 0, 0},
        Case{yards.source, yards.elsewhere, "no overlap", 1, 1, 0}}) {
    const auto aligned = [&](const std::vector<std::string>& more) {
      std::vector<std::string> command = {"scanlock-align", c.source, c.target, "--json"};
      command.insert(command.end(), more.begin(), more.end());
      return run(yards.folder, command);
    };
    CAPTURE(c.verdict);
    const Result standard = aligned({});
    CHECK(standard.code == c.certain);
    CHECK(says(standard.output, "\"verdict\":\"" + c.verdict + "\""));
    CHECK(standard.errors.empty() == (c.certain == 0));
    if (c.certain != 0) {
      CHECK(standard.errors.rfind("scanlock-align: the verdict is " + c.verdict + ": ", 0) == 0);
      CHECK(says(standard.errors, c.ambiguous == 0 ? "--accept ambiguous" : "--accept any"));
      CHECK(std::count(standard.errors.begin(), standard.errors.end(), '\n') == 1);
    }
    CHECK(aligned({"--accept", "certain"}).code == c.certain);
    CHECK(aligned({"--accept", "ambiguous"}).code == c.ambiguous);
    const Result any = aligned({"--accept", "any"});
    CHECK(any.code == c.any);
    CHECK(any.errors.empty());
  }
  CHECK(run(yards.folder, {"scanlock-align", here, there, "--accept", "all"}).code == 2);
}

TEST_CASE("clouds that hang upside down align as they do upright") {
  const Yards yards;
  Pose turn = Pose::Identity();
  turn.linear() = Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const std::string source = yards.folder / "hanging_source.pcd",
                    target = yards.folder / "hanging_target.pcd", truth = yards.folder / "hanging_truth.txt",
                    poses = yards.folder / "hanging.tum";
  write_cloud(source, moved(read_cloud(yards.source), turn));
  write_cloud(target, moved(read_cloud(yards.target), turn));
  const Pose hanging = turn * level_pose(2.2, 3, -2, 0.1) * turn.inverse();
  write_transform(truth, hanging);
  for (const std::string method : {"4dof", "4dof+robust-icp", "4dof+robust-icp-plane"}) {
    const Result result = run(yards.folder, {"scanlock-align", source, target, "--truth", truth, "--up",
                                             "0,0,-1", "--method", method, "--json"});
    CAPTURE(method);
    CHECK(result.code == 0);
    CHECK(says(result.output, "\"verdict\":\"certain\""));
    CHECK(number(result.output, "rotation_error_deg") < (method == "4dof" ? 1.0 : 0.2));
    CHECK(number(result.output, "translation_error") < (method == "4dof" ? 0.3 : 0.05));
  }
  REQUIRE(run(yards.folder, {"scanlock-align", target, source, "--chain", "--up", "0,0,-1", "--poses", poses})
              .code == 0);
  CHECK(near(read_tum(poses)[1].pose, hanging, 0.05, 0.0035));
}

TEST_CASE("align refuses a zero vertical, an epsilon that is not positive and an unknown method") {
  const Yards yards;
  CHECK(run(yards.folder, {"scanlock-align", yards.source, yards.target, "--up", "0,0,0"}).code == 2);
  CHECK(run(yards.folder, {"scanlock-align", yards.source, yards.target, "--epsilon", "0"}).code == 2);
  CHECK(run(yards.folder, {"scanlock-align", yards.source, yards.target, "--epsilon=-1"}).code == 2);
  CHECK(run(yards.folder, {"scanlock-align", yards.source, yards.target, "--method", "4dof+nothing"}).code ==
        2);
}

TEST_CASE("align chains clouds without an initial pose, and stops at a pair that is not certain") {
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
  std::vector<std::string> accepting = lost;
  accepting.insert(accepting.end(), {"--accept", "any"});
  const Result accepted = run(yards.folder, accepting);
  CHECK(accepted.code == 0);
  CHECK(accepted.errors.empty());
  CHECK(std::count(accepted.output.begin(), accepted.output.end(), '\n') == 3);
  lost.push_back("--json");
  const Result went_on = run(yards.folder, lost);
  CHECK(went_on.code == 0);
  CHECK(number(went_on.output, "clouds") == 3);
  CHECK(says(went_on.errors, yards.elsewhere + " to " + yards.source));
}
