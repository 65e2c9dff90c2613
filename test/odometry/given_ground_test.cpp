// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/given_ground.hpp"

#include <doctest/doctest.h>

#include "lost_points.hpp"

namespace scanlock {
namespace {

ArchivedKeyframe keyframe_at(double x) {
  PointCloud points;
  for (int i = 0; i < 36; ++i) points.push_back({static_cast<float>(i % 6), static_cast<float>(i / 6), 0});
  ArchivedKeyframe keyframe;
  keyframe.map_from_body.translation().x() = x;
  keyframe.reach = 6;
  keyframe.points = points;
  return keyframe;
}

constexpr double kVoxelSide = 0.5;  // metres

}  // namespace

TEST_CASE("the local map is founded on a given map where the given map shows the ground") {
  KeyframeArchive archive(1000000);
  REQUIRE(archive.restore({keyframe_at(0), keyframe_at(3)}, true).empty());
  Odometer odometer{TrackerConfig{}};
  GivenGround ground;
  odometer.set_pose(Pose(Eigen::Translation3d(50, 0, 0)));
  ground.follow(archive, kVoxelSide, &odometer);
  CHECK_FALSE(odometer.map().is_founded());
  odometer.set_pose(Pose::Identity());
  ground.follow(archive, kVoxelSide, &odometer);
  CHECK(odometer.map().is_founded());
  CHECK(odometer.map().keyframes().size() == 2);
}

TEST_CASE("an unreadable given map is not read again at each scan, but after the robot has moved") {
  KeyframeArchive archive(1000000);
  ArchivedKeyframe lost = keyframe_at(0);
  lost.points = lost_points();
  archive.restore({lost}, true);
  Odometer odometer{TrackerConfig{}};
  GivenGround ground;
  CHECK_THROWS_AS(ground.follow(archive, kVoxelSide, &odometer), PointsUnreadable);
  CHECK_NOTHROW(ground.follow(archive, kVoxelSide, &odometer));
  odometer.set_pose(Pose(Eigen::Translation3d(4, 0, 0)));
  CHECK_THROWS_AS(ground.follow(archive, kVoxelSide, &odometer), PointsUnreadable);
  ground.forget();
  CHECK_THROWS_AS(ground.follow(archive, kVoxelSide, &odometer), PointsUnreadable);
}

}  // namespace scanlock
