// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/odometer.hpp"

#include <doctest/doctest.h>

#include "room.hpp"

namespace scanlock {
namespace {

PreparedScan turned_scan(double angle, int i, VoxelScale* scale) {
  const Scan seen = nook_scan(angle, i);
  return thin_scan(seen.points, crop(seen.points, 0.1, 120), scale, i == 0, 2500);
}

}  // namespace

TEST_CASE("a planar robot that is found turned has the velocity of that turn") {
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

}  // namespace scanlock
