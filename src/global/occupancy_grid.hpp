// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// What the rays of a planar sensor tell about the cells of its plane.
class OccupancyGrid {
 public:
  enum State : std::uint8_t { kUnknown, kFree, kOccupied };

  /// `cloud`: points with the sensor origins that they were seen from, metres, in a frame whose x and y axes
  /// span the plane; the points of one origin are one scan. `cell`: metres, at least 1e-3. Points and
  /// cells farther than kMostCells cells from the frame's origin along an axis are left out.
  OccupancyGrid(const PointCloud& cloud, double cell);

  double cell() const { return cell_; }                 ///< metres
  const Eigen::Array2i& low() const { return low_; }    ///< the cell of lowest indices; cell 0 begins at 0
  const Eigen::Array2i& size() const { return size_; }  ///< numbers of cells along x and y
  /// Of the cell `low() + (x, y)`: occupied where more than half as many scans ended there as passed through;
  /// a moved object, and a wall that rays graze, have both. Precondition: within size().
  State state(int x, int y) const;

  static constexpr int kMostCells = 750;  ///< bounds the memory

 private:
  struct Counts {
    std::uint16_t ended = 0, passed = 0;  // numbers of scans
    std::uint32_t last = 0;               // scan that was counted last
  };
  std::ptrdiff_t index(const Eigen::Array2i& cell) const;  // -1: outside
  void add_scan(const PointCloud& cloud, const std::vector<std::uint32_t>& points, std::uint32_t number);

  double cell_;
  Eigen::Array2i low_ = Eigen::Array2i::Zero(), size_ = Eigen::Array2i::Zero();
  std::vector<Counts> counts_;
};

}  // namespace scanlock
