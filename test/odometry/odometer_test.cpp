// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/odometer.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "lost_points.hpp"
#include "room.hpp"

namespace scanlock {
namespace {

PreparedScan turned_scan(double angle, int i, VoxelScale* scale) {
  const Scan seen = nook_scan(angle, i);
  return thin_scan(seen.points, crop(seen.points, 0.1, 120), scale, i == 0, 2500);
}

}  // namespace

TEST_CASE("a planar robot that is found turned has the velocity of this turn") {
  const TrackerConfig config;
  for (const double turn : {-1.0, 0.6, 1.0}) {
    CAPTURE(turn);
    VoxelScale scale(config.map_points_per_scan, config.min_voxel_m, config.max_voxel_m);
    Odometer odometer(config);
    odometer.start(0, turned_scan(0, 0, &scale), {});
    for (int i = 1; i < 10; ++i)
      odometer.accept(odometer.align(turned_scan(0, i, &scale), odometer.predict(0.2), Reach::kNear));
    const MovingPose found =
        odometer.look_far(turned_scan(turn, 10, &scale), loosened(odometer.predict(0.2))).alignment.moving;
    const Vector6 way = se3_log(found.pose);
    CHECK(way[5] == doctest::Approx(turn).epsilon(0.02));
    CHECK(found.twist[5] == doctest::Approx(turn / 0.2).epsilon(0.4));
  }
}

TEST_CASE("a reloaded map holds the nearest keyframes of the new position, and none of the old one") {
  TrackerConfig config;
  config.max_keyframes = 10;
  config.max_map_points = 14 * 36;  // a fifth of it is reserved for new points
  std::vector<ArchivedKeyframe> archive;
  const std::vector<Eigen::Vector3d> centres = {{0, 0, 0}, {500, 0, 0}, {0, 900, 0}};
  for (const Eigen::Vector3d& centre : centres) {
    for (int k = 0; k < 15; ++k) {
      PointCloud points;
      for (int i = 0; i < 36; ++i)
        points.push_back({static_cast<float>(i % 6), static_cast<float>(i / 6), 0});
      ArchivedKeyframe keyframe;
      keyframe.map_from_body = Pose(Eigen::Translation3d(centre + Eigen::Vector3d(0, 0, 2.0 * k)));
      keyframe.points = points;
      archive.push_back(std::move(keyframe));
    }
  }
  Odometer odometer(config);
  odometer.reload(archive, centres[0], 0.5);
  odometer.reload(archive, centres[1], 0.5);
  for (const Keyframe& k : odometer.map().keyframes())
    CHECK((k.map_from_body.translation() - centres[1]).norm() < 50);
  CHECK(odometer.map().keyframes().size() == 10);
  CHECK(odometer.map().size() == 10 * 36);
}

TEST_CASE("a local map does not change where points of the next one cannot be read") {
  PointCloud points;
  for (int i = 0; i < 36; ++i) points.push_back({static_cast<float>(i % 6), static_cast<float>(i / 6), 0});
  std::vector<ArchivedKeyframe> archive(2);
  archive[0].points = points;
  archive[1].map_from_body.translation().x() = 3;
  Odometer odometer{TrackerConfig{}};
  odometer.reload({archive[0]}, Eigen::Vector3d::Zero(), 0.5);
  archive[1].points = lost_points();
  CHECK_THROWS_AS(odometer.reload(archive, Eigen::Vector3d::Zero(), 0.5), PointsUnreadable);
  REQUIRE(odometer.map().keyframes().size() == 1);
  CHECK(odometer.map().size() == 36);
}

}  // namespace scanlock
