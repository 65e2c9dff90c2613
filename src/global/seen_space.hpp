// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Surfaces and ray-traced free space of a cloud, as cells: a cell may hold a surface, may be crossed by rays
/// from the sensor to a point, or is unknown. It stores the headings of the rays, because a ray that grazes a
/// wall does not contradict the wall.
class SeenSpace {
 public:
  /// `cloud`: thinned by `voxel` (metres), with normals, levelled. Rays start at its sensor origins (eyes).
  SeenSpace(const PointCloud& cloud, float voxel);

  /// Whether a surface that is not level is within about two voxels of p.
  bool has_surface(const Eigen::Vector3f& p) const;
  /// Whether the column of p has cells with points or rays, but p is above all of them.
  bool is_above(const Eigen::Vector3f& p) const;
  /// Whether a ray crossed the cell of p, even if it holds a surface.
  bool was_seen_through(const Eigen::Vector3f& p) const { return headings(p) != 0; }
  /// Whether rays that do not graze a surface of that normal (unit, or zero) crossed the cell of p, and the
  /// cell below it, which no ray crosses if p is on the ground.
  bool is_crossed(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) const;

 private:
  Eigen::Array3i cell(const Eigen::Vector3f& p) const;
  std::ptrdiff_t index(const Eigen::Array3i& cell) const;   // -1: outside
  std::uint8_t headings(const Eigen::Vector3f& p) const;    // of the rays that crossed there
  std::ptrdiff_t column(const Eigen::Array3i& cell) const;  // -1: outside
  void mark_tops(const PointCloud& cloud);
  void mark_surfaces(const PointCloud& cloud);
  void trace_ray(const Eigen::Vector3f& from, const Eigen::Vector3f& to);

  float cell_size_;                                                              // metres
  Eigen::Array3i low_ = Eigen::Array3i::Zero(), size_ = Eigen::Array3i::Zero();  // cells
  std::vector<std::uint8_t> headings_;                                           // a bit for each sector
  std::vector<bool> surface_;
  std::vector<int> top_;  // of each column: the highest cell with a point or a ray; -1: none
};

}  // namespace scanlock
