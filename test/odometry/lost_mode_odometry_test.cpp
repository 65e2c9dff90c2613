// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/lost_mode_odometry.hpp"

#include <doctest/doctest.h>

#include "odometry/scan_preparation.hpp"
#include "room.hpp"

namespace scanlock {
namespace {

/// The velocity along x, m/s, that lost-mode odometry (LostModeOdometry) finds where another velocity is
/// predicted.
double found_velocity(double velocity, double predicted, int scans) {
  const TrackerConfig config;
  VoxelScale scale(config.map_points_per_scan, config.min_voxel_m, config.max_voxel_m);
  Vector6 twist = Vector6::Zero(), guess = Vector6::Zero();
  twist[0] = velocity;
  guess[0] = predicted;
  const auto scan = [&](int i) {
    const Scan seen = hall_scan(se3_exp(0.1 * i * twist), twist, 100000 * i, static_cast<unsigned>(i));
    const CroppedScan cropped = crop(seen.points, config.min_range_m, config.max_range_m);
    return thin_scan(seen.points, cropped, &scale, i == 0, config.max_source_points);
  };
  LostModeOdometry lost_odometry(config, 0, scan(0), {Pose::Identity(), guess});
  for (int i = 1; i <= scans; ++i) lost_odometry.follow(100000 * i, 0.1, scan(i));
  return lost_odometry.state().twist[0];
}

}  // namespace

TEST_CASE("lost-mode odometry finds the velocity where another velocity was predicted" *
          doctest::test_suite("many trials")) {
  for (double velocity : {-12.0, -6.0, 0.0, 6.0, 12.0}) {
    for (double predicted : {-12.0, 0.0, 12.0}) {
      CAPTURE(velocity);
      CAPTURE(predicted);
      CHECK_MESSAGE(std::abs(found_velocity(velocity, predicted, 3) - velocity) < 0.5, velocity, " ",
                    predicted, " ", found_velocity(velocity, predicted, 3));
    }
  }
}

}  // namespace scanlock
