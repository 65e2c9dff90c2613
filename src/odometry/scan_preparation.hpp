// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// The points of a scan that are finite and within [min_range, max_range] metres, as indices, and how large the scene is.
struct CroppedScan {
  std::vector<std::uint32_t> indices;
  double median_range = 0;  ///< metres, to about 3 %; 0 without points
};
CroppedScan crop(const PointCloud& points, double min_range, double max_range);

/// The voxel size that fits a scene, in steps of sqrt(2) and with hysteresis, so that it changes seldom.
class VoxelScale {
 public:
  VoxelScale(double voxel_per_range, double min_voxel, double max_voxel);
  /// Takes the median range of a scan, returns the voxel size to use, metres.
  double update(double median_range);

 private:
  double voxel_per_range_, min_voxel_, max_voxel_;
  double smoothed_log_range_ = 0;
  double voxel_ = 0;  ///< 0: no scan yet
};

/// A scan thinned to what the odometry works on; body frame, times kept.
struct PreparedScan {
  PointCloud fine;    ///< one point a map voxel: becomes the keyframe
  PointCloud source;  ///< a coarser part of it: is aligned
};
PreparedScan thin_scan(const PointCloud& points, const CroppedScan& cropped, double voxel, int max_source_points);

}  // namespace scanlock
