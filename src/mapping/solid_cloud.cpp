// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/solid_cloud.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/voxel_grid.hpp"

namespace scanlock {
namespace {

// Bits of a Morton key in a block (8 voxels a side) and in a cube (4 blocks a side).
constexpr int kBlockBits = 9, kCubeBits = 15;
constexpr std::uint64_t kInBlock = (1u << kBlockBits) - 1, kInCube = (1u << kCubeBits) - 1;
constexpr int kFineBits = 10;  // bits of a point's position in its voxel, along each axis
constexpr std::uint32_t kFine = 1u << kFineBits;
constexpr int kCubeSide = 1 << kCubeBits / 3;  // voxels
constexpr int kMostLevel = 2;
constexpr int kBeside = 4;  // occupied neighbours of 26 that make a surface: a plane has 8, a line 2
constexpr double kClosed = 3.0;
constexpr float kFarthest = 1048575;  // voxels: a key has 21 bits for each axis

using Bits = std::array<std::uint64_t, 8>;

std::uint64_t key_of(const Eigen::Vector3i& voxel) {
  return morton_key(voxel.x(), voxel.y(), voxel.z());
}

std::uint64_t block_bit_of(std::uint64_t key) {
  return (key & kInCube) >> kBlockBits;
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

/// The number of set bits before `bit`.
std::size_t rank(const Bits& bits, std::uint64_t bit) {
  std::size_t before = count(bits[bit >> 6] & ((std::uint64_t{1} << (bit & 63)) - 1));
  for (std::size_t word = 0; word < bit >> 6; ++word) before += count(bits[word]);
  return before;
}

/// Mask, within a word, of the voxel of that level that contains `bit`.
std::uint64_t of_level(std::uint64_t bit, int level) {
  const int size = 1 << 3 * level;
  const std::uint64_t ones = size == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << size) - 1;
  return ones << (bit & 63 & ~static_cast<std::uint64_t>(size - 1));
}

/// The number of voxels that hold points, for each size from the smallest to a block.
std::array<std::uint32_t, kMostLevel + 2> voxels(const Bits& taken) {
  std::array<std::uint32_t, kMostLevel + 2> result{0, 0, 0, 1};
  for (const std::uint64_t word : taken) {
    result[0] += static_cast<std::uint32_t>(count(word));
    for (int byte = 0; byte < 64; byte += 8) result[1] += (word >> byte & 255) != 0 ? 1 : 0;
    result[2] += word != 0 ? 1 : 0;
  }
  return result;
}

/// A point's position in its voxel, 10 bits per axis; `in_voxels`: its coordinates in voxels.
std::uint32_t packed(const Eigen::Vector3f& in_voxels) {
  std::uint32_t result = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float part = in_voxels[axis] - std::floor(in_voxels[axis]);
    const auto place = std::min(static_cast<std::uint32_t>(part * static_cast<float>(kFine)), kFine - 1);
    result = result << kFineBits | place;
  }
  return result;
}

Eigen::Vector3i unpacked(std::uint32_t place) {
  const auto axis = [&](int bits) { return static_cast<int>(place >> bits & (kFine - 1)); };
  return {axis(2 * kFineBits), axis(kFineBits), axis(0)};
}

/// Squared distance from the centre of the voxel, in units of half a step of the packed coordinates.
int squared_distance(std::uint32_t place) {
  return (2 * unpacked(place).array() + 1 - static_cast<int>(kFine)).matrix().squaredNorm();
}

}  // namespace

std::size_t SolidCloud::Cube::place(std::uint64_t bit) const {
  return count(blocks & ((std::uint64_t{1} << bit) - 1));
}

const SolidCloud::Block* SolidCloud::Cube::block(std::uint64_t bit) const {
  return (blocks >> bit & 1) != 0 ? &held[place(bit)] : nullptr;
}

void SolidCloud::add(const PointCloud& part) {
  std::uint64_t last_key = ~std::uint64_t{0};
  Block* block = nullptr;                                             // the block of `last_key`
  const float margin = static_cast<float>(1 << kMostLevel) * voxel_;  // the largest voxel that a point fills
  // Grows by a quarter only: these lists are most of the memory.
  const auto make_room = [](auto* list) {
    if (list->size() == list->capacity()) list->reserve(list->size() + list->size() / 4 + 1);
  };
  for (std::size_t i = 0; i < part.size(); ++i) {
    const Eigen::Vector3f p = part.point(i), in_voxels = p / voxel_;
    if (!p.allFinite()) {
      ++not_finite_;
      continue;
    }
    if (!(in_voxels.cwiseAbs().maxCoeff() < kFarthest)) {
      ++too_far_;
      continue;
    }
    const std::uint64_t key = scanlock::key_of(voxel_of(p, voxel_));
    if (key >> kBlockBits != last_key) {
      last_key = key >> kBlockBits;
      const auto at = cube_at_.insert(key >> kCubeBits, static_cast<std::uint32_t>(cubes_.size()));
      if (at == cubes_.size()) cubes_.emplace_back(key >> kCubeBits);
      Cube& cube = cubes_[at];
      const std::uint64_t bit = block_bit_of(key);
      const std::size_t place = cube.place(bit);
      if ((cube.blocks >> bit & 1) == 0) {
        cube.blocks |= std::uint64_t{1} << bit;
        make_room(&cube.held);
        cube.held.emplace(cube.held.begin() + static_cast<std::ptrdiff_t>(place));
      }
      block = &cube.held[place];
    }
    const std::uint64_t bit = key & kInBlock;
    const auto place = static_cast<std::ptrdiff_t>(rank(block->taken, bit));
    const std::uint32_t now = packed(in_voxels);
    if (!holds(block->taken, bit)) {
      block->taken[bit >> 6] |= std::uint64_t{1} << (bit & 63);
      make_room(&block->points);
      block->points.insert(block->points.begin() + place, now);
      ++size_;
    } else {
      std::uint32_t& kept = block->points[static_cast<std::size_t>(place)];
      if (std::pair(squared_distance(now), now) < std::pair(squared_distance(kept), kept)) kept = now;
    }
    low_ = low_.cwiseMin(p - Eigen::Vector3f::Constant(margin));
    high_ = high_.cwiseMax(p + Eigen::Vector3f::Constant(margin));
  }
}

void SolidCloud::close() {
  for (Cube& cube : cubes_) {
    std::array<std::uint32_t, kMostLevel + 2> sums{};  // voxels of each size
    for (const Block& block : cube.held) {
      const auto of_block = voxels(block.taken);
      for (std::size_t level = 0; level < of_block.size(); ++level) sums[level] += of_block[level];
    }
    std::size_t level = 0;
    while (level <= kMostLevel && sums[level] < kClosed * sums[level + 1]) ++level;
    cube.level = level > kMostLevel ? 0 : static_cast<int>(level);
    if (cube.level == 0) continue;
    for (std::uint64_t bit = 0; bit < 64; ++bit)
      if ((cube.blocks >> bit & 1) != 0) fill(cube, bit, &cube.held[cube.place(bit)]);
  }
}

void SolidCloud::forget_below(float x) {
  for (Cube& cube : cubes_) {
    const int end = morton_cell(cube.key << kCubeBits).x() + kCubeSide;
    if (cube.blocks == 0 || static_cast<float>(end) * voxel_ > x) continue;
    cube.blocks = 0;
    cube.held = std::vector<Block>();  // {} would keep the memory
  }
}

/// Marks the grown voxels of a block that are solid.
void SolidCloud::fill(const Cube& cube, std::uint64_t block_bit, Block* block) const {
  const std::uint64_t first = cube.key << kCubeBits | block_bit << kBlockBits;
  std::size_t place = 0;
  for (std::uint64_t bit = 0; bit <= kInBlock; ++bit) {
    if (!holds(block->taken, bit)) continue;
    if (!goes_on(position(first | bit, block->points[place++]), cube.level)) continue;
    block->filled |= cube.level == 1 ? std::uint64_t{1} << (bit >> 3) : std::uint64_t{255} << (bit >> 6 << 3);
  }
}

/// Whether the grown voxel of a point has enough occupied neighbours to be part of a surface.
bool SolidCloud::goes_on(const Eigen::Vector3f& point, int level) const {
  const auto size = static_cast<float>(1 << level) * voxel_;
  int beside = 0;
  for (int i = 0; i < 27 && beside < kBeside; ++i) {
    if (i == 13) continue;
    const Eigen::Vector3i step(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1);
    const std::uint64_t key = scanlock::key_of(voxel_of(point + size * step.cast<float>(), voxel_));
    const Block* block = block_of(cube_of(key), key);
    const std::uint64_t bit = key & kInBlock;
    beside += block && (block->taken[bit >> 6] & of_level(bit, level)) != 0 ? 1 : 0;
  }
  return beside >= kBeside;
}

const SolidCloud::Cube* SolidCloud::cube_of(std::uint64_t key) const {
  const std::optional<std::uint32_t> at = cube_at_.at(key >> kCubeBits);
  return at ? &cubes_[*at] : nullptr;
}

const SolidCloud::Block* SolidCloud::block_of(const Cube* cube, std::uint64_t key) {
  return cube ? cube->block(block_bit_of(key)) : nullptr;
}

Eigen::Vector3f SolidCloud::position(std::uint64_t key, std::uint32_t place) const {
  const Eigen::Vector3d in_voxel =
      (unpacked(place).cast<double>().array() + 0.5) / static_cast<double>(kFine);
  return ((morton_cell(key).cast<double>() + in_voxel) * static_cast<double>(voxel_)).cast<float>();
}

std::vector<SolidCloud::BlockId> SolidCloud::blocks() const {
  std::vector<BlockId> result;
  for (std::size_t i = 0; i < cubes_.size(); ++i)
    for (BlockId bit = 0; bit < 64; ++bit)
      if ((cubes_[i].blocks >> bit & 1) != 0) result.push_back(static_cast<BlockId>(i) << 6 | bit);
  return result;
}

float SolidCloud::block_edge() const {
  return voxel_ * static_cast<float>(1 << kBlockBits / 3);
}

Eigen::Vector3f SolidCloud::middle_of(BlockId id) const {
  const Eigen::Vector3i corner = morton_cell(key_of(id << kBlockBits));
  return voxel_ * (corner.cast<float>().array() + static_cast<float>(1 << kBlockBits / 3) / 2);
}

std::vector<Eigen::Vector3f> SolidCloud::points_of(BlockId id) const {
  const Block& block = *cubes_[id >> 6].block(id & 63);
  std::vector<Eigen::Vector3f> result;
  for (std::uint64_t bit = 0; bit <= kInBlock; ++bit)
    if (holds(block.taken, bit))
      result.push_back(position(key_of(id << kBlockBits | bit), block.points[result.size()]));
  return result;
}

std::uint64_t SolidCloud::key_of(Voxel voxel) const {
  return cubes_[voxel >> kCubeBits].key << kCubeBits | (voxel & kInCube);
}

Eigen::Vector3f SolidCloud::point(Voxel voxel) const {
  const Block& block = *cubes_[voxel >> kCubeBits].block(block_bit_of(voxel));
  return position(key_of(voxel), block.points[rank(block.taken, voxel & kInBlock)]);
}

bool SolidCloud::is_before(Voxel a, Voxel b) const {
  return key_of(a) < key_of(b);
}

bool SolidCloud::is_solid(const Eigen::Vector3f& position) const {
  const std::uint64_t key = scanlock::key_of(voxel_of(position, voxel_));
  const Block* block = block_of(cube_of(key), key);
  return block && block->is_solid(key & kInBlock);
}

/// Steps from voxel to voxel along the ray (Amanatides and Woo 1987), and across an empty block or cube in
/// one step.
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
    // The ray ends at the bounding box of the cloud.
    range = std::min(range, ((direction[axis] > 0 ? high_ : low_)[axis] - eye[axis]) / direction[axis]);
  }
  /// Metres along the ray to where it leaves the box of `side` voxels a side that contains `at`.
  const auto leaves = [&](int axis, int side) {
    if (direction[axis] == 0) return kNever;
    const int begin = at[axis] & ~(side - 1);
    const float border = voxel_ * static_cast<float>(direction[axis] > 0 ? begin + side : begin);
    return (border - eye[axis]) / direction[axis];
  };
  const Cube* cube = nullptr;
  std::uint64_t cube_key = ~std::uint64_t{0};
  Eigen::Vector3f next(leaves(0, 1), leaves(1, 1), leaves(2, 1));
  for (bool first = true;; first = false) {
    const std::uint64_t key = scanlock::key_of(at);
    if (key >> kCubeBits != cube_key) cube = cube_of(key);
    cube_key = key >> kCubeBits;
    const Block* block = block_of(cube, key);
    const bool solid = block && block->is_solid(key & kInBlock);
    if (solid && !first) return nearest(key, *cube, eye + (next - delta).maxCoeff() * direction);
    if (block) {
      int axis = 0;
      if (!(next.minCoeff(&axis) < range)) return std::nullopt;
      at[axis] += direction[axis] > 0 ? 1 : -1;
      next[axis] += delta[axis];
      continue;
    }
    int axis = 0;
    const int side = cube ? 8 : kCubeSide;
    const float out = Eigen::Vector3f(leaves(0, side), leaves(1, side), leaves(2, side)).minCoeff(&axis);
    if (!(out < range)) return std::nullopt;
    const Eigen::Vector3i there = voxel_of(eye + out * direction, voxel_);
    for (int i = 0; i < 3; ++i) {  // leaves the box by one side only, whatever the rounding
      const int begin = at[i] & ~(side - 1), end = begin + side - 1;
      at[i] = i != axis ? std::clamp(there[i], begin, end) : direction[i] > 0 ? end + 1 : begin - 1;
      next[i] = leaves(i, 1);
    }
  }
}

/// The voxel with the point nearest to `position`, in the grown voxel (of the cube's level) of `key`.
SolidCloud::Voxel SolidCloud::nearest(std::uint64_t key, const Cube& cube,
                                      const Eigen::Vector3f& position) const {
  const Block& block = *cube.block(block_bit_of(key));
  const std::uint64_t word = (key & kInBlock) >> 6, wanted = of_level(key, cube.level);
  std::size_t place = rank(block.taken, word << 6);
  std::uint64_t best = 0;
  float least = std::numeric_limits<float>::infinity();
  for (std::uint64_t bit = 0; bit < 64; ++bit) {
    if ((block.taken[word] >> bit & 1) == 0) continue;
    const std::uint32_t packed = block.points[place++];
    if ((wanted >> bit & 1) == 0) continue;
    const std::uint64_t candidate = (key >> kBlockBits << kBlockBits) | word << 6 | bit;
    const float distance = (this->position(candidate, packed) - position).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    best = candidate;
  }
  return static_cast<Voxel>(&cube - cubes_.data()) << kCubeBits | (best & kInCube);
}

}  // namespace scanlock
