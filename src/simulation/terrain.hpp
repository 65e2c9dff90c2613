// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "simulation/shapes.hpp"

namespace scanlock {

/// The ground as a height field: one bilinear patch per square cell, continuous everywhere. Metres, world
/// frame.
class Terrain {
 public:
  Terrain() = default;
  /// Samples `height` at the corners of the cells that cover the rectangle from `low` to `high`.
  Terrain(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double cell,
          const std::function<double(double x, double y)>& height);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  double cell() const { return cell_; }
  const Eigen::Vector2d& low() const { return low_; }
  Eigen::Vector2d high() const { return low_ + cell_ * Eigen::Vector2d(columns_, rows_); }

  /// Height of the ground; outside the rectangle, that of its nearest edge.
  double height(double x, double y) const;
  double highest(int column, int row) const;
  double lowest(int column, int row) const;

  /// Replaces `hit` when the ray hits this cell's patch at a shorter range, between `enter` and `leave`.
  void intersect_cell(int column, int row, const Ray& ray, double enter, double leave, Hit& hit) const;

 private:
  double corner(int column, int row) const { return heights_[row * (columns_ + 1) + column]; }

  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  double cell_ = 1;
  int columns_ = 0, rows_ = 0;
  std::vector<double> heights_;
};

}  // namespace scanlock
