// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"

namespace scanlock {

/// What surrounds a place, for telling which places to search first: how many points stand above the sensor
/// in each cell of rings and sectors about it (a polar histogram, as Kim and Kim's scan context 2018 has of
/// heights). What is lower, the ground, cars and people, is left out where something is higher: a
/// planar sensor sees nothing that is. It does not depend on the heading, and little on the sensor.
class PlaceSignature {
 public:
  static constexpr double kReach = 60.0;  ///< metres: what is farther off does not count

  /// `points`: relative to the sensor; `level` turns them so that z is up.
  PlaceSignature(const PointCloud& points, const Eigen::Matrix3f& level);

  /// The cosine of the two at the heading where they are most alike: 0 to 1; 0 where one is empty.
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
