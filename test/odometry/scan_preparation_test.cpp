// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/scan_preparation.hpp"

#include <doctest/doctest.h>

#include "odometry/tracker_config.hpp"

namespace scanlock {

TEST_CASE("the voxel size follows the number of remaining points, and nearly empty scans do not change it") {
  const TrackerConfig config;
  VoxelScale scale(config.map_points_per_scan, config.min_voxel_m, config.max_voxel_m);
  const double voxel = scale.current(10.0);
  for (int i = 0; i < 10; ++i) CHECK_FALSE(scale.adapt(20, 20, false));
  CHECK(scale.current(10.0) == voxel);
  CHECK(scale.adapt(60000, 60000, false));
  CHECK(scale.current(10.0) > voxel);
}

}  // namespace scanlock
