// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// A cloud as voxels that hide what is behind them. Coordinates in metres.
/// Where points lie apart, voxels grow until the surfaces there have no holes: to the smallest size, by
/// doubling, in which the points of a cube of 32 voxels take three times the voxels that they take in one of
/// twice the size. A surface without holes takes four times as many, scattered points take as many; where
/// that is not reached by two doublings, and where a voxel has few others beside it, they are scattered, and
/// hide no more than their own voxels.
class SolidCloud {
 public:
  /// Points that are not finite are left out. `voxel`: metres, the smallest.
  SolidCloud(const PointCloud& cloud, float voxel);

  /// One point a voxel of the smallest size.
  const PointCloud& points() const { return points_; }
  bool is_solid(const Eigen::Vector3f& position) const;
  /// A point of the voxel that a ray hits first; none within `range` metres. `direction`: unit. The voxel of
  /// `eye` does not stop it.
  std::optional<std::uint32_t> hit(const Eigen::Vector3f& eye, const Eigen::Vector3f& direction,
                                   float range) const;

 private:
  /// Eight voxels a side.
  struct Block {
    std::array<std::uint64_t, 8> solid{};  // bits in Morton order
    int level = 0;                         // doublings
    bool holds(std::uint64_t bit) const { return (solid[bit >> 6] >> (bit & 63) & 1) != 0; }
    void add(std::uint64_t bit) { solid[bit >> 6] |= std::uint64_t{1} << (bit & 63); }
  };
  const Block* block_of(std::uint64_t key) const;
  bool goes_on(const Eigen::Vector3f& point, int level) const;
  void fill(std::size_t begin, std::size_t end);
  std::uint32_t nearest(std::uint64_t key, int level, const Eigen::Vector3f& position) const;

  float voxel_;
  PointCloud points_;                // in Morton order of their voxels,
  std::vector<std::uint64_t> keys_;  // which are these
  Eigen::Vector3f low_ = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity()), high_ = -low_;
  std::unordered_map<std::uint64_t, std::uint32_t> block_at_;
  std::vector<Block> blocks_;
};

}  // namespace scanlock
