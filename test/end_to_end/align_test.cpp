// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "align_samples.hpp"
#include "geometry/rigid.hpp"
#include "io/cloud_file.hpp"
#include "io/trajectory.hpp"

using namespace scanlock;
using namespace scanlock::test;

namespace {

/// A square of flat ground, 3000 points.
PointCloud ground(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> side(-4, 4);
  PointCloud cloud;
  for (int i = 0; i < 3000; ++i) {
    const float x = side(random), y = side(random);
    cloud.push_back(x, y, 0);
  }
  return cloud;
}

struct Files {
  TemporaryFolder folder;
  std::string source = folder / "source.ply", target = folder / "target.ply", truth = folder / "truth.txt";
  Files() {
    Pose pose = Pose::Identity();  // yaw of 0.05 rad and 0.1 m along x, source to target
    pose.linear() = so3_exp({0, 0, 0.05});
    pose.translation() = Eigen::Vector3d(0.1, 0, 0);
    PointCloud moved;
    const PointCloud cloud = corner(2);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      moved.push_back(Eigen::Vector3f((pose.inverse() * cloud.point(i).cast<double>()).cast<float>()));
    write_cloud(source, moved);
    write_cloud(target, corner(1));
    write_transform(truth, pose);
  }
};

}  // namespace

TEST_CASE("scanlock-align prints every documented JSON member and writes its files") {
  const Files files;
  const std::string aligned = files.folder / "aligned.ply", picture = files.folder / "picture.svg";
  const Result result =
      run(files.folder, {"scanlock-align", files.source, files.target, "--method", "robust-icp-plane",
                         "--truth", files.truth, "--output", aligned, "--picture", picture, "--json"});
  REQUIRE(result.code == 0);
  for (const char* key : {"method",
                          "transform",
                          "points",
                          "iterations",
                          "sweeps",
                          "stop_reason",
                          "energy",
                          "inlier_ratio",
                          "covariance",
                          "degenerate_axes",
                          "ms",
                          "read",
                          "normals",
                          "index",
                          "solve",
                          "total",
                          "peak_rss_mb",
                          "rmse",
                          "rotation_error_deg",
                          "translation_error"}) {
    CAPTURE(key);
    CHECK(result.output.find("\"" + std::string(key) + "\":") != std::string::npos);
  }
  const double kibibytes = number(result.output, "peak_rss_mb") * 1e6 / 1024;  // an MB is 1e6 bytes
  CHECK(kibibytes == doctest::Approx(std::round(kibibytes)).epsilon(1e-9));
  CHECK(number(result.output, "rmse") < 0.005);
  CHECK(number(result.output, "rotation_error_deg") < 0.1);
  CHECK(read_cloud(aligned).size() == 3000);
  CHECK(read_file(picture).rfind("<svg", 0) == 0);
  CHECK(read_file(picture).find("from the front") != std::string::npos);
}

TEST_CASE("scanlock-align starts at the pose of --init") {
  const Files files;
  const Result result = run(files.folder, {"scanlock-align", files.source, files.target, "--method", "icp",
                                           "--init", files.truth, "--truth", files.truth, "--json"});
  REQUIRE(result.code == 0);
  CHECK(number(result.output, "rotation_error_deg") < 0.5);
}

TEST_CASE(
    "scanlock-align fails where the clouds leave an axis unconstrained, unless --accept ambiguous is given") {
  const TemporaryFolder folder;
  const std::string source = folder / "source.ply", target = folder / "target.ply";
  write_cloud(source, ground(1));
  write_cloud(target, ground(2));
  std::vector<std::string> command = {"scanlock-align",   source,  target, "--method",
                                      "robust-icp-plane", "--json"};
  const Result refused = run(folder, command);
  CHECK(refused.code == 1);
  CHECK(refused.output.find("\"degenerate_axes\":[\"x\",\"y\",\"rz\"]") != std::string::npos);
  CHECK(refused.errors ==
        "scanlock-align: the alignment is degenerate: the clouds do not constrain x, y, rz; "
        "--accept ambiguous accepts it\n");
  command.insert(command.end(), {"--accept", "ambiguous"});
  const Result accepted = run(folder, command);
  CHECK(accepted.code == 0);
  CHECK(accepted.errors.empty());
}

TEST_CASE("scanlock-align reports an error in one line") {
  const Files files;
  const std::string two = files.folder / "two.xyz", bad = files.folder / "bad.txt";
  write_file(two, "0 0 0\n1 0 0\n");
  write_file(bad, "1 0 0 0\n0 1 0 zero\n0 0 1 0\n0 0 0 1\n");
  struct Wrong {
    std::vector<std::string> arguments;
    int code;
    std::string words;
  };
  const Wrong cases[] = {
      {{files.source, two}, 1, two + ": 2 finite points"},
      {{two, files.target}, 1, two + ": 2 finite points"},
      {{files.source, files.folder / "none.ply"}, 1, "none.ply"},
      {{files.source, files.target, "--init", bad}, 1, bad + ": row 2, number 4"},
      {{files.source, files.target, "--method", "magic"}, 2, "magic"},
      {{files.source, files.target, "--voxel", "-1"}, 2, "voxel"},
      {{files.source}, 2, "TARGET"},
  };
  for (const Wrong& wrong : cases) {
    std::vector<std::string> command = {"scanlock-align"};
    command.insert(command.end(), wrong.arguments.begin(), wrong.arguments.end());
    const Result result = run(files.folder, command);
    CAPTURE(result.errors);
    CHECK(result.code == wrong.code);
    CHECK(result.output.empty());
    CHECK(result.errors.find(wrong.words) != std::string::npos);
  }
}

TEST_CASE("scanlock-align registers a chain and writes its poses and map") {
  const Files files;
  const std::string poses = files.folder / "poses.tum", map = files.folder / "map.ply";
  const Result result =
      run(files.folder, {"scanlock-align", files.target, files.source, files.target, "--chain", "--method",
                         "robust-icp-plane", "--poses", poses, "--output", map, "--json"});
  REQUIRE(result.code == 0);
  CHECK(number(result.output, "clouds") == 3);
  CHECK(number(result.output, "length") == doctest::Approx(0.2).epsilon(0.05));
  const Trajectory trajectory = read_tum(poses);
  REQUIRE(trajectory.size() == 3);
  CHECK(trajectory[1].pose.translation().x() == doctest::Approx(0.1).epsilon(0.05));
  CHECK(trajectory[2].pose.translation().norm() < 0.005);
  CHECK(trajectory[2].time_s == 2);
  CHECK(read_cloud(map).size() == 9000);
  CHECK(run(files.folder, {"scanlock-align", files.source, files.target, files.target}).code == 2);
}
