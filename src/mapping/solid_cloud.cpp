// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/solid_cloud.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "geometry/voxel_grid.hpp"

namespace scanlock {
namespace {

constexpr int kBlockBits = 9, kCubeBits = 6;  // of Morton keys: 8 voxels a side, and 4 blocks
constexpr std::uint64_t kInBlock = (1u << kBlockBits) - 1;
constexpr int kMostLevel = 2;
constexpr int kBeside = 4;  // of 26: a plane has 8, a line 2
constexpr double kClosed = 3.0;
constexpr float kFarthest = 1048575;  // voxels: a key has 21 bits for each axis

using Bits = std::array<std::uint64_t, 8>;

std::uint64_t key_of(const Eigen::Vector3i& voxel) {
  return morton_key(voxel.x(), voxel.y(), voxel.z());
}

Eigen::Vector3i voxel_of(const Eigen::Vector3f& position, float voxel) {
  return (position / voxel).array().floor().cast<int>();
}

std::size_t count(std::uint64_t bits) {
  return std::bitset<64>(bits).count();
}

bool holds(const Bits& bits, std::uint64_t bit) {
  return (bits[bit >> 6] >> (bit & 63) & 1) != 0;
}

/// How many of them come before that one.
std::size_t rank(const Bits& bits, std::uint64_t bit) {
  std::size_t before = count(bits[bit >> 6] & ((std::uint64_t{1} << (bit & 63)) - 1));
  for (std::size_t word = 0; word < bit >> 6; ++word) before += count(bits[word]);
  return before;
}

/// Those of the voxel of that level, of one word, which `bit` is in.
std::uint64_t of_level(std::uint64_t bit, int level) {
  const int size = 1 << 3 * level;
  const std::uint64_t ones = size == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << size) - 1;
  return ones << (bit & 63 & ~static_cast<std::uint64_t>(size - 1));
}

/// Voxels of each size, from the smallest to a block, that hold points.
std::array<std::uint32_t, kMostLevel + 2> voxels(const Bits& taken) {
  std::array<std::uint32_t, kMostLevel + 2> result{0, 0, 0, 1};
  for (const std::uint64_t word : taken) {
    result[0] += static_cast<std::uint32_t>(count(word));
    for (int byte = 0; byte < 64; byte += 8) result[1] += (word >> byte & 255) != 0 ? 1 : 0;
    result[2] += word != 0 ? 1 : 0;
  }
  return result;
}

}  // namespace

void SolidCloud::add(const PointCloud& part) {
  std::uint64_t block_key = ~std::uint64_t{0};
  std::uint32_t at = 0;                                               // of that block
  const float margin = static_cast<float>(1 << kMostLevel) * voxel_;  // what a point fills at most
  for (std::size_t i = 0; i < part.size(); ++i) {
    const Eigen::Vector3f p = part.point(i), in_voxels = p / voxel_;
    if (!(in_voxels.cwiseAbs().maxCoeff() < kFarthest) || !in_voxels.allFinite()) continue;
    const std::uint64_t key = key_of(voxel_of(p, voxel_));
    if (key >> kBlockBits != block_key) {
      block_key = key >> kBlockBits;
      at = block_at_.insert(block_key, static_cast<std::uint32_t>(blocks_.size()));
      if (at == blocks_.size()) blocks_.emplace_back(block_key);
    }
    Block& block = blocks_[at];
    const std::uint64_t bit = key & kInBlock;
    const std::size_t place = rank(block.taken, bit);
    if (!holds(block.taken, bit)) {
      block.taken[bit >> 6] |= std::uint64_t{1} << (bit & 63);
      std::vector<Eigen::Vector3f>& points = block.points;
      // By a quarter: most of the memory is here.
      if (points.size() == points.capacity()) points.reserve(points.size() + points.size() / 4 + 4);
      points.insert(points.begin() + static_cast<std::ptrdiff_t>(place), p);
      ++size_;
    } else {
      const auto distance = [&](const Eigen::Vector3f& q) {
        const Eigen::Vector3f r = q / voxel_;
        return (r.array() - r.array().floor() - 0.5F).matrix().squaredNorm();
      };
      Eigen::Vector3f& kept = block.points[place];
      const float old = distance(kept), now = distance(p);
      if (std::tie(now, p.x(), p.y(), p.z()) < std::tie(old, kept.x(), kept.y(), kept.z())) kept = p;
    }
    low_ = low_.cwiseMin(p - Eigen::Vector3f::Constant(margin));
    high_ = high_.cwiseMax(p + Eigen::Vector3f::Constant(margin));
  }
}

void SolidCloud::close() {
  std::vector<std::array<std::uint32_t, kMostLevel + 2>> cubes;  // voxels of each size in them
  for (const Block& block : blocks_) {
    const auto cube = cube_at_.insert(block.key >> kCubeBits, static_cast<std::uint32_t>(cubes.size()));
    if (cube == cubes.size()) cubes.push_back({});
    const auto of_block = voxels(block.taken);
    for (std::size_t level = 0; level < of_block.size(); ++level) cubes[cube][level] += of_block[level];
  }
  for (Block& block : blocks_) {
    const auto& sums = cubes[*cube_at_.at(block.key >> kCubeBits)];
    std::size_t level = 0;
    while (level <= kMostLevel && sums[level] < kClosed * sums[level + 1]) ++level;
    block.level = level > kMostLevel ? 0 : static_cast<int>(level);
    fill(&block);
  }
}

/// What of a block is solid.
void SolidCloud::fill(Block* block) const {
  block->solid = block->taken;
  if (block->level == 0) return;
  std::size_t place = 0;
  for (std::uint64_t bit = 0; bit <= kInBlock; ++bit) {
    if (!holds(block->taken, bit)) continue;
    if (goes_on(block->points[place++], block->level)) block->solid[bit >> 6] |= of_level(bit, block->level);
  }
}

/// Whether the voxel of a point has others beside it: it is part of a surface.
bool SolidCloud::goes_on(const Eigen::Vector3f& point, int level) const {
  const auto size = static_cast<float>(1 << level) * voxel_;
  int beside = 0;
  for (int i = 0; i < 27 && beside < kBeside; ++i) {
    if (i == 13) continue;
    const Eigen::Vector3i step(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1);
    const std::uint64_t key = key_of(voxel_of(point + size * step.cast<float>(), voxel_));
    const Block* block = block_of(key);
    const std::uint64_t bit = key & kInBlock;
    beside += block && (block->taken[bit >> 6] & of_level(bit, level)) != 0 ? 1 : 0;
  }
  return beside >= kBeside;
}

const SolidCloud::Block* SolidCloud::block_of(std::uint64_t key) const {
  const std::optional<std::uint32_t> at = block_at_.at(key >> kBlockBits);
  return at ? &blocks_[*at] : nullptr;
}

Eigen::Vector3f SolidCloud::point(Voxel voxel) const {
  const Block& block = blocks_[voxel >> kBlockBits];
  return block.points[rank(block.taken, voxel & kInBlock)];
}

bool SolidCloud::is_before(Voxel a, Voxel b) const {
  const auto place = [&](Voxel v) { return std::pair(blocks_[v >> kBlockBits].key, v & kInBlock); };
  return place(a) < place(b);
}

bool SolidCloud::is_solid(const Eigen::Vector3f& position) const {
  const std::uint64_t key = key_of(voxel_of(position, voxel_));
  const Block* block = block_of(key);
  return block && holds(block->solid, key & kInBlock);
}

/// From voxel to voxel along the ray (Amanatides and Woo 1987), and over empty blocks and cubes at once.
std::optional<SolidCloud::Voxel> SolidCloud::hit(const Eigen::Vector3f& eye, const Eigen::Vector3f& direction,
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
    const bool solid = block && holds(block->solid, key & kInBlock);
    if (solid && !first) return nearest(key, *block, eye + (next - delta).maxCoeff() * direction);
    if (block) {
      int axis = 0;
      if (!(next.minCoeff(&axis) < range)) return std::nullopt;
      at[axis] += direction[axis] > 0 ? 1 : -1;
      next[axis] += delta[axis];
      continue;
    }
    int axis = 0;
    const int side = cube_at_.at(key >> kBlockBits >> kCubeBits) ? 8 : 32;
    const float out = Eigen::Vector3f(leaves(0, side), leaves(1, side), leaves(2, side)).minCoeff(&axis);
    if (!(out < range)) return std::nullopt;
    const Eigen::Vector3i there = voxel_of(eye + out * direction, voxel_);
    for (int i = 0; i < 3; ++i) {  // whatever the rounding, it leaves the box by one side only
      const int begin = at[i] & ~(side - 1), end = begin + side - 1;
      at[i] = i != axis ? std::clamp(there[i], begin, end) : direction[i] > 0 ? end + 1 : begin - 1;
      next[i] = leaves(i, 1);
    }
  }
}

/// Of those in the voxel of a block's level.
SolidCloud::Voxel SolidCloud::nearest(std::uint64_t key, const Block& block,
                                      const Eigen::Vector3f& position) const {
  const std::uint64_t word = (key & kInBlock) >> 6, wanted = of_level(key, block.level);
  std::size_t place = rank(block.taken, word << 6);
  std::uint64_t best = 0;
  float least = std::numeric_limits<float>::infinity();
  for (std::uint64_t bit = 0; bit < 64; ++bit) {
    if ((block.taken[word] >> bit & 1) == 0) continue;
    const float distance = (block.points[place++] - position).squaredNorm();
    if ((wanted >> bit & 1) == 0 || !(distance < least)) continue;
    least = distance;
    best = word << 6 | bit;
  }
  return static_cast<Voxel>(&block - blocks_.data()) << kBlockBits | best;
}

}  // namespace scanlock
