// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "odometry/keyframe_archive.hpp"
#include "odometry/scan_preparation.hpp"
#include "odometry/tracker_config.hpp"
#include "room.hpp"

namespace scanlock {

/// A sensor at rest in the hall of room.hpp, with its scans prepared as by a tracker.
class PreparedHall {
 public:
  explicit PreparedHall(const TrackerConfig& config)
      : config_(config), scale_(config.map_points_per_scan, config.min_voxel_m, config.max_voxel_m) {}

  /// The first scan sets the voxel.
  PreparedScan scan(unsigned i) {
    Scan seen = hall_scan(Pose::Identity(), Vector6::Zero(), 100000 * i, i);
    seen.points.time.clear();
    return thin_scan(seen.points, crop(seen.points, config_.min_range_m, config_.max_range_m), &scale_,
                     i == 0, config_.max_source_points);
  }

 private:
  TrackerConfig config_;
  VoxelScale scale_;
};

/// The points of the hall, by 30,000 rays.
inline PointCloud hall_map() {
  Scan map = hall_scan(Pose::Identity(), Vector6::Zero(), 0, 100, 0.1, 30000);
  map.points.time.clear();
  return map.points;
}

inline ArchivedKeyframe archived(const Pose& pose, const PointCloud& points) {
  return {0, pose, 10.0f, points};
}

}  // namespace scanlock
