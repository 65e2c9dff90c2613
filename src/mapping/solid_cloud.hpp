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

/// A cloud as opaque voxels, for ray tracing. Coordinates in metres. Where points are sparse, voxels grow
/// until the surfaces have no holes: in each cube of 32 voxels a side to the smallest size, by at most two
/// doublings, at which the points occupy three times as many voxels as at twice that size (a surface without
/// holes occupies four times as many, scattered points just as many). Where there is no such size or a voxel
/// has fewer than 4 occupied neighbours, points count as scattered and occlude no more than their own voxels.
/// Takes some 130 bytes for each block of 8 voxels a side that holds a point, and 4 for each further voxel
/// that holds a point, however many points there are.
class SolidCloud {
 public:
  /// Ids of a voxel of the smallest size that holds a point, and of a block that holds a point.
  using Voxel = std::uint64_t;
  using BlockId = std::uint64_t;

  /// `voxel`: the smallest size, metres.
  explicit SolidCloud(float voxel) : voxel_(voxel) {}
  /// Keeps the point nearest to the centre of each voxel, rounded to 1/1024 of the voxel, whatever the order
  /// of points. Points that are not finite, or 2^20 voxels or more from the origin, are left out and counted.
  void add(const PointCloud& part);
  /// Grows the voxels; call once, after the last point. Before that only voxels with points are solid.
  void close();

  /// Removes all cubes of 32 voxels a side that lie below this x, metres.
  void forget_below(float x);

  std::size_t size() const { return size_; }                ///< voxels that hold a point
  std::uint64_t not_finite() const { return not_finite_; }  ///< points left out as not finite
  std::uint64_t too_far() const { return too_far_; }        ///< and as too far from the origin
  std::vector<BlockId> blocks() const;                      ///< the blocks that hold a point
  float block_edge() const;                                 ///< metres
  Eigen::Vector3f middle_of(BlockId block) const;
  std::vector<Eigen::Vector3f> points_of(BlockId block) const;
  Eigen::Vector3f point(Voxel voxel) const;
  /// Whether `a` comes before `b` in Morton order.
  bool is_before(Voxel a, Voxel b) const;
  bool is_solid(const Eigen::Vector3f& position) const;
  /// The first voxel that a ray hits within `range` metres; where it hits a grown voxel, the smallest-size
  /// voxel in it whose point is nearest to where the ray enters. `direction`: unit vector. The voxel of `eye`
  /// itself does not stop the ray.
  std::optional<Voxel> hit(const Eigen::Vector3f& eye, const Eigen::Vector3f& direction, float range) const;

 private:
  /// Eight voxels a side.
  struct Block {
    std::array<std::uint64_t, 8> taken{};  ///< bits of the voxels that hold points, in Morton order
    /// Bits of the voxels of twice the size that are solid, in Morton order.
    std::uint64_t filled = 0;
    /// Points of the voxels in `taken`, in that order, from the voxel's corner: 10 bits per axis.
    std::vector<std::uint32_t> points;
    bool is_solid(std::uint64_t bit) const {
      return (taken[bit >> 6] >> (bit & 63) & 1) != 0 || (filled >> (bit >> 3) & 1) != 0;
    }
  };
  /// Four blocks a side.
  struct Cube {
    explicit Cube(std::uint64_t cube_key) : key(cube_key) {}
    std::uint64_t key;                            ///< Morton key of the cube
    std::uint64_t blocks = 0;                     ///< bits of the blocks that hold points, in Morton order
    int level = 0;                                ///< number of doublings of its voxels
    std::vector<Block> held;                      ///< the blocks in `blocks`, in that order
    std::size_t place(std::uint64_t bit) const;   ///< index in `held` of the block of that bit
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
  VoxelIndex cube_at_;  ///< index in `cubes_`, by key
  std::vector<Cube> cubes_;
};

}  // namespace scanlock
