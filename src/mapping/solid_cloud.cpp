// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/solid_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/radix_sort.hpp"
#include "geometry/voxel_grid.hpp"

namespace scanlock {
namespace {

constexpr int kBlockBits = 9, kCubeBits = 15;  // of a Morton key: 8 and 32 voxels a side
constexpr std::uint64_t kInBlock = (1u << kBlockBits) - 1;
constexpr int kMostLevel = 2;
constexpr int kBeside = 4;  // of 26: a plane has 8, a line 2
constexpr double kClosed = 3.0;

std::uint64_t key_of(const Eigen::Vector3i& voxel) {
  return morton_key(voxel.x(), voxel.y(), voxel.z());
}

Eigen::Vector3i voxel_of(const Eigen::Vector3f& position, float voxel) {
  return (position / voxel).array().floor().cast<int>();
}

}  // namespace

SolidCloud::SolidCloud(const PointCloud& cloud, float voxel) : voxel_(voxel) {
  // Ordered by keys of our own: another rounding would put some points into the voxel next to theirs.
  std::vector<KeyedIndex> order;
  for (const std::uint32_t i : thin_by_voxel(cloud, voxel))
    order.emplace_back(key_of(voxel_of(cloud.point(i), voxel)), i);
  radix_sort(&order);
  const float margin = static_cast<float>(1 << kMostLevel) * voxel;  // what a point fills at most
  for (const auto& [key, index] : order) {
    const Eigen::Vector3f p = cloud.point(index);
    keys_.push_back(key);
    points_.push_back(p);
    low_ = low_.cwiseMin(p - Eigen::Vector3f::Constant(margin));
    high_ = high_.cwiseMax(p + Eigen::Vector3f::Constant(margin));
  }
  for (std::size_t begin = 0, end = 0; begin < keys_.size(); begin = end) {
    while (end < keys_.size() && keys_[end] >> kCubeBits == keys_[begin] >> kCubeBits) ++end;
    fill(begin, end);
  }
}

/// Points of one cube.
void SolidCloud::fill(std::size_t begin, std::size_t end) {
  const auto voxels = [&](int level) {
    double count = 0;
    for (std::size_t i = begin; i < end; ++i)
      count += i == begin || keys_[i] >> 3 * level != keys_[i - 1] >> 3 * level ? 1 : 0;
    return count;
  };
  int level = 0;
  while (level <= kMostLevel && voxels(level) < kClosed * voxels(level + 1)) ++level;
  if (level > kMostLevel) level = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const auto [at, added] =
        block_at_.emplace(keys_[i] >> kBlockBits, static_cast<std::uint32_t>(blocks_.size()));
    if (added) blocks_.emplace_back();
    Block& block = blocks_[at->second];
    block.level = level;
    block.add(keys_[i] & kInBlock);
    if (level == 0 || !goes_on(points_.point(i), level)) continue;
    const std::uint64_t first = (keys_[i] & kInBlock) >> 3 * level << 3 * level;
    for (std::uint64_t bit = first; bit < first + (std::uint64_t{1} << 3 * level); ++bit) block.add(bit);
  }
}

/// Whether the voxel of a point has others beside it: it is part of a surface.
bool SolidCloud::goes_on(const Eigen::Vector3f& point, int level) const {
  const auto size = static_cast<float>(1 << level) * voxel_;
  int beside = 0;
  for (int i = 0; i < 27 && beside < kBeside; ++i) {
    if (i == 13) continue;
    const Eigen::Vector3i step(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1);
    const std::uint64_t key = key_of(voxel_of(point + size * step.cast<float>(), voxel_)) >> 3 * level;
    const auto at = std::lower_bound(keys_.begin(), keys_.end(), key << 3 * level);
    beside += at != keys_.end() && *at >> 3 * level == key ? 1 : 0;
  }
  return beside >= kBeside;
}

const SolidCloud::Block* SolidCloud::block_of(std::uint64_t key) const {
  const auto at = block_at_.find(key >> kBlockBits);
  return at == block_at_.end() ? nullptr : &blocks_[at->second];
}

bool SolidCloud::is_solid(const Eigen::Vector3f& position) const {
  const std::uint64_t key = key_of(voxel_of(position, voxel_));
  const Block* block = block_of(key);
  return block && block->holds(key & kInBlock);
}

/// From voxel to voxel along the ray (Amanatides and Woo 1987), and over empty blocks at once.
std::optional<std::uint32_t> SolidCloud::hit(const Eigen::Vector3f& eye, const Eigen::Vector3f& direction,
                                             float range) const {
  constexpr float kNever = std::numeric_limits<float>::infinity();
  Eigen::Vector3i at = voxel_of(eye, voxel_);
  Eigen::Vector3f delta;  // metres along the ray from border to border
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) {
      delta[axis] = kNever;
      continue;
    }
    delta[axis] = voxel_ / std::abs(direction[axis]);
    // Beyond what is there nothing is hit.
    range = std::min(range, ((direction[axis] > 0 ? high_ : low_)[axis] - eye[axis]) / direction[axis]);
  }
  /// Metres along the ray to where it leaves the box of so many voxels a side that `at` is in.
  const auto leaves = [&](int axis, int side) {
    if (direction[axis] == 0) return kNever;
    const int begin = at[axis] & ~(side - 1);
    const float border = voxel_ * static_cast<float>(direction[axis] > 0 ? begin + side : begin);
    return (border - eye[axis]) / direction[axis];
  };
  const Block* block = nullptr;
  std::uint64_t block_key = ~std::uint64_t{0};
  Eigen::Vector3f next(leaves(0, 1), leaves(1, 1), leaves(2, 1));
  for (bool first = true;; first = false) {
    const std::uint64_t key = key_of(at);
    if (key >> kBlockBits != block_key) block = block_of(key);
    block_key = key >> kBlockBits;
    const bool solid = block && block->holds(key & kInBlock);
    if (solid && !first) return nearest(key, block->level, eye + (next - delta).maxCoeff() * direction);
    if (block) {
      int axis = 0;
      if (!(next.minCoeff(&axis) < range)) return std::nullopt;
      at[axis] += direction[axis] > 0 ? 1 : -1;
      next[axis] += delta[axis];
      continue;
    }
    int axis = 0;
    const float out = Eigen::Vector3f(leaves(0, 8), leaves(1, 8), leaves(2, 8)).minCoeff(&axis);
    if (!(out < range)) return std::nullopt;
    const Eigen::Vector3i there = voxel_of(eye + out * direction, voxel_);
    for (int i = 0; i < 3; ++i) {  // whatever the rounding, it leaves the block by one side only
      const int begin = at[i] & ~7, end = begin + 7;
      at[i] = i != axis ? std::clamp(there[i], begin, end) : direction[i] > 0 ? end + 1 : begin - 1;
      next[i] = leaves(i, 1);
    }
  }
}

/// Of the points of a voxel.
std::uint32_t SolidCloud::nearest(std::uint64_t key, int level, const Eigen::Vector3f& position) const {
  const std::uint64_t first = key >> 3 * level << 3 * level;
  auto i = std::lower_bound(keys_.begin(), keys_.end(), first);
  std::uint32_t best = 0;
  float least = std::numeric_limits<float>::infinity();
  for (; i != keys_.end() && *i >> 3 * level == key >> 3 * level; ++i) {
    const auto index = static_cast<std::uint32_t>(i - keys_.begin());
    const float distance = (points_.point(index) - position).squaredNorm();
    if (distance < least) {
      least = distance;
      best = index;
    }
  }
  return best;
}

}  // namespace scanlock
