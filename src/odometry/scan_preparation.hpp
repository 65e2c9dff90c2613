// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// With fewer points, some of which are outliers, six degrees of freedom are not determined.
inline constexpr std::size_t kLeastPoints = 30;

/// Whether all points lie in the plane of x and y; those that are not finite do not count.
bool is_planar(const PointCloud& points);

/// The points of a scan that are finite and within [min_range, max_range] metres, as indices, and their
/// median range.
struct CroppedScan {
  std::vector<std::uint32_t> indices;
  double median_range = 0;  ///< metres, to about 3 %; 0 without points
};
CroppedScan crop(const PointCloud& points, double min_range, double max_range);

/// The voxel size of the map: that which thins a scan to about `wanted` points, in steps of 2^(1/4) and with
/// hysteresis, so that it changes seldom. It follows the size of the scene and the density of the sensor, so
/// that the work on a scan is about constant.
class VoxelScale {
 public:
  /// Sizes in metres.
  VoxelScale(int wanted, double min_voxel, double max_voxel);
  /// The size to use for a scan with this median range (a first guess) and this many points within range.
  double current(double median_range);
  /// Takes the numbers of points to which the last scan was cropped and thinned, unless below kLeastPoints;
  /// true when that changes the size. `planar`: points lie on lines, not on surfaces.
  bool adapt(std::size_t thinned, std::size_t cropped, bool planar);

 private:
  double wanted_, min_voxel_, max_voxel_;
  double voxel_ = 0;  ///< 0: no scan yet
};

/// A scan thinned for odometry; body frame, times kept.
struct PreparedScan {
  PointCloud fine;    ///< one point per map voxel: becomes the keyframe
  PointCloud source;  ///< a coarser part of it, which is aligned
  PointCloud rays;    ///< every n-th of the cropped points, so as dense by direction as the sensor's beams
  double voxel = 0;   ///< metres, of `fine`
  double median_range = 0;  ///< metres
  std::size_t whole = 0;    ///< number of points of the source, before part_of() took a part of it
  bool planar = false;      ///< all points lie in the plane of x and y, which is all that the sensor sees
};
/// The reason why fewer than kLeastPoints of a scan are left, in words; ranges in metres.
std::string why_too_few(const PointCloud& points, const CroppedScan& cropped, double min_range,
                        double max_range);

/// Thins a cropped scan. `first`: the voxel size is adapted until it settles on this scan.
PreparedScan thin_scan(const PointCloud& points, const CroppedScan& cropped, VoxelScale* scale, bool first,
                       int max_source_points);

}  // namespace scanlock
