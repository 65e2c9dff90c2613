// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/log_poses.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>

#include "io/lcm_log.hpp"
#include "io/trajectory_source.hpp"
#include "messages/encode.hpp"
#include "temporary_directory.hpp"

namespace scanlock {
namespace {

/// A level pose, so that pose2D_t, too, has all of its components.
TrackedScan tracked(std::int64_t utime) {
  TrackedScan scan;
  scan.utime = utime;
  scan.map_from_body = Pose::Identity();
  scan.map_from_body.translate(Eigen::Vector3d(1.5, -2.25, 0));
  scan.map_from_body.rotate(Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitZ()));
  return scan;
}

std::vector<Bytes> every_pose_type(std::int64_t utime) {
  const TrackedScan scan = tracked(utime);
  return {encode_pose(scan, TwistFrame::kLocal), encode_rigid_transform(scan), encode_pose2d(scan),
          encode_nav_odometry(scan, "map", "body", 1), encode_odometry(scan, {})};
}

}  // namespace

TEST_CASE("every pose type gives the pose and its own stamp") {
  constexpr std::int64_t kUtime = 1763695123000001;
  for (const Bytes& message : every_pose_type(kUtime)) {
    std::string error;
    const auto stamped = decode_pose(message.data(), message.size(), error);
    REQUIRE(stamped);
    CHECK(std::llround(stamped->time_s * 1e6) == kUtime);
    CHECK((stamped->pose.matrix() - tracked(0).map_from_body.matrix()).cwiseAbs().maxCoeff() < 1e-6);
  }
}

TEST_CASE("a cut pose message is decoded only if the missing part lies behind the pose") {
  for (const Bytes& message : every_pose_type(1)) {
    for (std::size_t size = 0; size < message.size(); ++size) {
      std::string error;
      const Bytes cut(message.begin(), message.begin() + static_cast<std::ptrdiff_t>(size));
      const auto stamped = decode_pose(cut.data(), cut.size(), error);
      CHECK(stamped.has_value() == error.empty());
      if (stamped) CHECK(stamped->pose.isApprox(tracked(0).map_from_body, 1e-6));
    }
  }
}

TEST_CASE("poses of a log are read from the given channel, and invalid ones are counted") {
  TemporaryDirectory directory;
  const std::string path = directory / "a.lcmlog";
  TrackedScan wrong = tracked(3000000);
  wrong.map_from_body.translation().x() = std::numeric_limits<double>::quiet_NaN();
  LogWriter writer(path);
  writer.write(90, "LIDAR", {1, 2, 3});
  writer.write(91, kDefaultPoseChannel, encode_pose(tracked(1000000), TwistFrame::kLocal));
  writer.write(92, kDefaultPoseChannel, encode_pose(wrong, TwistFrame::kLocal));
  writer.write(93, "TRUTH", encode_rigid_transform(tracked(2000000)));
  writer.close();
  const LogPoses poses = read_log_poses(path, kDefaultPoseChannel);
  REQUIRE(poses.trajectory.size() == 1);
  CHECK(poses.trajectory[0].time_s == 1.0);
  CHECK(poses.rejected == 1);
  CHECK(poses.first_error == "the position is not finite");
  CHECK(load_trajectory(path).trajectory.size() == 1);
  const LoadedTrajectory truth = load_trajectory(path + ":TRUTH");
  CHECK(truth.trajectory.at(0).time_s == 2.0);
  CHECK(truth.name == "a.lcmlog:TRUTH");
  CHECK_THROWS_WITH_AS(load_trajectory(path + ":NONE"), doctest::Contains("the log has LIDAR POSE"),
                       std::runtime_error);
  CHECK_THROWS_WITH_AS(load_trajectory(path + ":LIDAR"), doctest::Contains("holds no pose"),
                       std::runtime_error);
  CHECK_THROWS_WITH_AS(load_trajectory(directory / "no.tum"), doctest::Contains("no.tum: no such file"),
                       std::runtime_error);
}

}  // namespace scanlock
