// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace scanlock {

/// Everything about the odometry that can be set. The defaults serve a car and a room alike: lengths that
/// depend on the scene follow its size. `daemon/config.cpp` lists every member with its unit, range and one
/// line of explanation.
struct TrackerConfig {
  double min_range_m = 0.5;  ///< returns nearer than this are the robot itself
  double planar_min_range_m =
      0.1;                     ///< the same for a planar sensor: most are mounted to see nothing of the robot
  double max_range_m = 120.0;  ///< returns farther than this are dropped
  int threads = 1;             ///< worker threads of one alignment; the result does not depend on it

  int map_points_per_scan =
      14000;                     ///< the voxel of the map is chosen to leave about so many points of a scan
  double min_voxel_m = 0.03;     ///< twice the noise of ranges: in finer voxels surfaces consist of noise
  double max_voxel_m = 0.7;      ///< in coarser voxels a trunk has no surface
  int max_source_points = 2500;  ///< points of a scan that are aligned

  double acceleration = 5.0;           ///< m/s^2, standard deviation, for the prediction
  double angular_acceleration = 10.0;  ///< rad/s^2, likewise

  int max_keyframes = 60;
  int max_map_points = 200000;
  double new_map_after_s = 5.0;  ///< of being lost, with scans that fit each other, until a new submap begins

  double search_cores = 0.1;  ///< CPU cores that searches may use, averaged over a minute

  int max_archive_points = 2000000;  ///< of all archived keyframes
};

}  // namespace scanlock
