// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// The space that a cloud was seen in, as cells: where its surfaces are, and what the rays crossed from where
/// its points were seen to them. Of the rays it keeps the headings, for a ray that grazes a wall says
/// nothing against the wall.
class SeenSpace {
 public:
  /// `cloud`: thinned by `voxel` (metres), with normals, levelled.
  SeenSpace(const PointCloud& cloud, float voxel);

  /// Whether a surface that is not level is about there, give or take a voxel or two.
  bool has_surface(const Eigen::Vector3f& p) const;
  /// Whether a ray went through p, whatever is there.
  bool was_seen_through(const Eigen::Vector3f& p) const { return headings(p) != 0; }
  /// Whether a ray went through a surface at p (normal: unit, or zero) that is not the ground.
  bool is_crossed(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) const;

 private:
  Eigen::Array3i cell(const Eigen::Vector3f& p) const;
  std::ptrdiff_t index(const Eigen::Array3i& cell) const;  // -1: outside
  std::uint8_t headings(const Eigen::Vector3f& p) const;   // of the rays that crossed there
  void mark_surfaces(const PointCloud& cloud);
  void trace_ray(const Eigen::Vector3f& from, const Eigen::Vector3f& to);

  float cell_size_;                                                              // metres
  Eigen::Array3i low_ = Eigen::Array3i::Zero(), size_ = Eigen::Array3i::Zero();  // cells
  std::vector<std::uint8_t> headings_;                                           // a bit for each sector
  std::vector<bool> surface_;
};

}  // namespace scanlock
