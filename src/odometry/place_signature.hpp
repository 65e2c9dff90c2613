// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"

namespace scanlock {

/// A descriptor of a keyframe, for sorting the places to search: the number of points above the sensor in
/// each cell of rings and sectors around it (a polar histogram; scan context, Kim and Kim 2018, has heights
/// in its cells). Where no point is above the sensor, as for a planar sensor, all points count (also ground,
/// cars, people). similarity() does not depend on the heading, and little on the sensor.
class PlaceSignature {
 public:
  static constexpr double kReach = 60.0;  ///< metres: points farther off do not count

  /// `points`: relative to the sensor; `level` turns them so that z is up.
  PlaceSignature(const PointCloud& points, const Eigen::Matrix3f& level);

  /// The largest cosine of the two descriptors over all headings: 0 to 1; 0 where one is empty.
  double similarity(const PlaceSignature& other) const;

 private:
  static constexpr std::size_t kRings = 20, kSectors = 60, kCells = kRings * kSectors;
  static bool count(const PointCloud& points, const Eigen::Matrix3f& level, bool high,
                    std::array<double, kCells>* counts);

  /// A cell that is not empty.
  struct Cell {
    std::uint8_t ring, sector;
    std::int16_t value;  ///< square root of a count, in sixteenths
  };
  std::vector<Cell> cells_;
  double norm_ = 0;
};

}  // namespace scanlock
