// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Integer coordinates of a voxel packed into one key, 21 bits each; valid while |coordinate| < 2^20 voxels.
/// The key is a Morton code: its order keeps neighbours in space near each other.
std::uint64_t morton_key(std::int32_t ix, std::int32_t iy, std::int32_t iz);
/// The cell with that key.
Eigen::Vector3i morton_cell(std::uint64_t key);

/// Thins a cloud to one point a voxel: of the points in a voxel the one nearest to its centre, ties going to
/// the smallest (x, y, z). The answer is a set of indices into the cloud in Morton order of their voxels, and
/// depends neither on the order of the points nor on what else is in the cloud. Points that are not finite,
/// or more than 2^20 voxels from the origin, are left out. `voxel` in metres, > 0.
std::vector<std::uint32_t> thin_by_voxel(const PointCloud& cloud, float voxel);

/// The same over a part of the cloud, given as indices.
std::vector<std::uint32_t> thin_by_voxel(const PointCloud& cloud, const std::vector<std::uint32_t>& subset,
                                         float voxel);

/// Gathers points and leaves those of thin_by_voxel(). It thins them in between, too, which leaves the same
/// points, so that it holds at most twice as many as are left, or half a million. `voxel` in metres, > 0.
class ThinnedCloud {
 public:
  explicit ThinnedCloud(float voxel) : voxel_(voxel) {}
  /// To append points to, of the same attributes each time. Call settle() now and then.
  PointCloud& points() { return points_; }
  void settle();
  PointCloud take();

 private:
  void thin();

  float voxel_;
  PointCloud points_;
  std::size_t most_ = std::size_t{1} << 19;  ///< points, before they are thinned
};

/// How many points thin_by_voxel() would leave.
std::size_t count_voxels(const PointCloud& cloud, float voxel);

/// One point a voxel: the mean of the points in it, and the mean of their normals (of those that are finite;
/// opposite signs count as one direction; zero where there is none), in Morton order of the voxels. Noise
/// averages out, as far as a voxel holds several points. Other attributes are dropped; points are left out as
/// in thin_by_voxel(). The order of the points matters to the last bits only.
PointCloud average_by_voxel(const PointCloud& cloud, float voxel);

/// The points at `indices`, with every attribute that the cloud has.
PointCloud select(const PointCloud& cloud, const std::vector<std::uint32_t>& indices);

}  // namespace scanlock
