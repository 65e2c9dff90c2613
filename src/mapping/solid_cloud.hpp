// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "odometry/voxel_index.hpp"

namespace scanlock {

/// A cloud as opaque voxels, for ray tracing. Coordinates in metres.
/// Where points lie apart, voxels grow until the surfaces there have no holes: to the smallest size, by
/// doubling, in which the points of a cube of 32 voxels take three times the voxels that they take in one of
/// twice the size. A surface without holes takes four times as many, scattered points take as many; where
/// that is not reached by two doublings, and where a voxel has few others beside it, they are scattered, and
/// hide no more than their own voxels.
/// Takes some 130 bytes for each block of 8 voxels a side that holds a point, and 4 for each further voxel
/// that holds one, however many points there are.
class SolidCloud {
 public:
  /// A voxel of the smallest size that holds a point, and the block that it is in.
  using Voxel = std::uint64_t;
  using BlockId = std::uint64_t;

  /// `voxel`: metres, the smallest.
  explicit SolidCloud(float voxel) : voxel_(voxel) {}
  /// Of the points in a voxel the one nearest to its centre is kept, to 1/1024 of the voxel, whatever their
  /// order. Points that are not finite, or more than 2^20 voxels from the origin, are left out and
  /// counted.
  void add(const PointCloud& part);
  /// After the last point: nothing is solid before.
  void close();

  /// Removes voxels at smaller x than this, metres, except up to 3 m of them.
  void forget_below(float x);

  std::size_t size() const { return size_; }                ///< voxels that hold a point
  std::uint64_t not_finite() const { return not_finite_; }  ///< points that were left out
  std::uint64_t too_far() const { return too_far_; }
  std::vector<BlockId> blocks() const;  ///< that hold a point
  float block_edge() const;             ///< metres
  Eigen::Vector3f middle_of(BlockId block) const;
  std::vector<Eigen::Vector3f> points_of(BlockId block) const;
  Eigen::Vector3f point(Voxel voxel) const;
  /// Whether the first of two voxels comes first in Morton order.
  bool is_before(Voxel a, Voxel b) const;
  bool is_solid(const Eigen::Vector3f& position) const;
  /// The first voxel that a ray hits within `range` metres: of a grown voxel, the nearest small one that
  /// holds a point. `direction`: unit. The voxel of `eye` itself does not stop the ray.
  std::optional<Voxel> hit(const Eigen::Vector3f& eye, const Eigen::Vector3f& direction, float range) const;

 private:
  /// Eight voxels a side.
  struct Block {
    std::array<std::uint64_t, 8> taken{};  ///< bits of the voxels that hold points, in Morton order
    std::uint64_t filled = 0;              ///< bits of the voxels of twice the size that are solid, likewise
    std::vector<std::uint32_t> points;  ///< of those, in that order, from the voxel's corner: 10 bits an axis
    bool is_solid(std::uint64_t bit) const {
      return (taken[bit >> 6] >> (bit & 63) & 1) != 0 || (filled >> (bit >> 3) & 1) != 0;
    }
  };
  /// Four blocks a side.
  struct Cube {
    explicit Cube(std::uint64_t cube_key) : key(cube_key) {}
    std::uint64_t key;                            ///< Morton, of the cube
    std::uint64_t blocks = 0;                     ///< bits of the blocks that hold points, in Morton order
    int level = 0;                                ///< doublings of its voxels
    std::vector<Block> held;                      ///< of those, in that order
    std::size_t place(std::uint64_t bit) const;   ///< in `held`, of a block of that bit
    const Block* block(std::uint64_t bit) const;  ///< null where it holds no point
  };

  const Cube* cube_of(std::uint64_t key) const;  ///< null where it holds no point
  static const Block* block_of(const Cube* cube, std::uint64_t key);
  bool goes_on(const Eigen::Vector3f& point, int level) const;
  void fill(const Cube& cube, std::uint64_t block_bit, Block* block) const;
  Eigen::Vector3f position(std::uint64_t key, std::uint32_t packed) const;
  std::uint64_t key_of(Voxel voxel) const;
  Voxel nearest(std::uint64_t key, const Cube& cube, const Eigen::Vector3f& position) const;

  float voxel_;
  std::size_t size_ = 0;
  std::uint64_t not_finite_ = 0, too_far_ = 0;
  Eigen::Vector3f low_ = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity()), high_ = -low_;
  VoxelIndex cube_at_;  ///< by their keys
  std::vector<Cube> cubes_;
};

}  // namespace scanlock
