// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Fewer points cannot fix six numbers against outliers.
inline constexpr std::size_t kLeastPoints = 30;

/// Whether all points lie in the plane of x and y; those that are not finite do not count.
bool is_planar(const PointCloud& points);

/// The points of a scan that are finite and within [min_range, max_range] metres, as indices, and how large
/// the scene is.
struct CroppedScan {
  std::vector<std::uint32_t> indices;
  double median_range = 0;  ///< metres, to about 3 %; 0 without points
};
CroppedScan crop(const PointCloud& points, double min_range, double max_range);

/// The voxel size of the map, in steps of sqrt(2) and with hysteresis, so that it changes seldom: the one
/// that leaves about `wanted` points of a scan. It follows the size of the scene and the density of the
/// sensor alike, and makes the work on a scan about constant.
class VoxelScale {
 public:
  /// Sizes in metres.
  VoxelScale(int wanted, double min_voxel, double max_voxel);
  /// The size to use for a scan with this median range (a first guess) and this many points within range.
  double current(double median_range);
  /// Takes how many points the last scan was thinned to; true when the size changed by it: a scan of fewer
  /// than kLeastPoints says nothing of the scene. `planar`: they lie on lines.
  bool adapt(std::size_t thinned, std::size_t cropped, bool planar);

 private:
  double wanted_, min_voxel_, max_voxel_;
  double voxel_ = 0;  ///< 0: no scan yet
};

/// A scan thinned to what the odometry works on; body frame, times kept.
struct PreparedScan {
  PointCloud fine;          ///< one point a map voxel: becomes the keyframe
  PointCloud source;        ///< a coarser part of it: is aligned
  PointCloud rays;          ///< some of all its points, as densely in every direction as the sensor looks
  double voxel = 0;         ///< metres, of `fine`
  double median_range = 0;  ///< metres
  std::size_t whole = 0;    ///< points of the source, also of one that this is a part of
  bool planar = false;      ///< all its points lie in the plane of x and y: that is all the sensor sees
};
/// Why too few points of a scan are left to align, in words for who set the ranges (metres).
std::string why_too_few(const PointCloud& points, const CroppedScan& cropped, double min_range,
                        double max_range);

PreparedScan thin_scan(const PointCloud& points, const CroppedScan& cropped, VoxelScale* scale, bool first,
                       int max_source_points);

}  // namespace scanlock
