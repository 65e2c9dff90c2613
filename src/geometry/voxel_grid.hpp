// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Integer coordinates of a voxel packed into one key, 21 bits each; valid while |coordinate| < 2^20 voxels.
/// The key is a Morton code: voxels that are close in space have keys that are mostly close in order.
std::uint64_t morton_key(std::int32_t ix, std::int32_t iy, std::int32_t iz);
/// The voxel with that key: the inverse of morton_key().
Eigen::Vector3i morton_cell(std::uint64_t key);

/// Thins a cloud to one point per voxel: the point nearest to the centre of the voxel, ties going to the
/// smallest (x, y, z). Returns indices into the cloud in Morton order of their voxels. The choice depends
/// neither on the order of the points nor on points of other voxels. Points that are not finite, or with a
/// coordinate of 2^20 - 1 voxels or more, are left out. `voxel` in metres, > 0; throws std::invalid_argument
/// otherwise.
std::vector<std::uint32_t> thin_by_voxel(const PointCloud& cloud, float voxel);

/// thin_by_voxel() over the points at the indices `subset`.
std::vector<std::uint32_t> thin_by_voxel(const PointCloud& cloud, const std::vector<std::uint32_t>& subset,
                                         float voxel);

/// Gathers points and thins them by thin_by_voxel(). settle() thins in between, which does not change the
/// result, so that after it the object holds at most twice the points left by the last thinning, or 2^19.
/// `voxel` in metres, > 0.
class ThinnedCloud {
 public:
  explicit ThinnedCloud(float voxel) : voxel_(voxel) {}
  /// The caller appends points, always with the same attributes, and calls settle() from time to time.
  PointCloud& points() { return points_; }
  void settle();
  PointCloud take();

 private:
  void thin();

  float voxel_;
  PointCloud points_;
  std::size_t most_ = std::size_t{1} << 19;  ///< number of points from which settle() thins
};

/// The number of points that thin_by_voxel() would leave.
std::size_t count_voxels(const PointCloud& cloud, float voxel);

/// One point per voxel, in Morton order of the voxels: the mean of the points in it, and the unit vector of
/// the mean of their finite normals (opposite normals count as one direction; zero where no normal is
/// finite). Where a voxel holds several points, noise averages out. Other attributes are dropped; points are
/// left out as in thin_by_voxel(). The order of the points changes only the last bits of the result.
PointCloud average_by_voxel(const PointCloud& cloud, float voxel);

/// The points at `indices`, with all attributes of the cloud.
PointCloud select(const PointCloud& cloud, const std::vector<std::uint32_t>& indices);

}  // namespace scanlock
