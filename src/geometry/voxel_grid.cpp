// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/voxel_grid.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "geometry/radix_sort.hpp"

namespace scanlock {
namespace {

constexpr float kMaxVoxels = 1048575.0f;  // 2^20 - 1 on each side of the origin

/// Spreads the low 21 bits of v to every third bit.
std::uint64_t spread_bits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffULL;
  v = (v | v << 16) & 0x1f0000ff0000ffULL;
  v = (v | v << 8) & 0x100f00f00f00f00fULL;
  v = (v | v << 4) & 0x10c30c30c30c30c3ULL;
  v = (v | v << 2) & 0x1249249249249249ULL;
  return v;
}

/// Gathers every third of 63 bits: the inverse of spread_bits.
std::uint64_t gathered_bits(std::uint64_t v) {
  v &= 0x1249249249249249;
  v = (v | v >> 2) & 0x10c30c30c30c30c3;
  v = (v | v >> 4) & 0x100f00f00f00f00f;
  v = (v | v >> 8) & 0x1f0000ff0000ff;
  v = (v | v >> 16) & 0x1f00000000ffff;
  return (v | v >> 32) & 0x1fffff;
}

struct Voxel {
  std::int32_t ix, iy, iz;
  float squared_distance_to_centre;
};

/// Two instructions, whereas std::floor is a function call on processors without SSE 4.1.
std::int32_t floor_to_int(float v) {
  const std::int32_t truncated = static_cast<std::int32_t>(v);
  return truncated - (v < static_cast<float>(truncated) ? 1 : 0);
}

/// The voxel of a point; false for points that are not finite or kMaxVoxels or more from the origin.
bool locate(float x, float y, float z, float inverse_size, Voxel* voxel) {
  const float fx = x * inverse_size, fy = y * inverse_size, fz = z * inverse_size;
  // Written so that NaN fails too.
  if (!(std::abs(fx) < kMaxVoxels && std::abs(fy) < kMaxVoxels && std::abs(fz) < kMaxVoxels)) return false;
  voxel->ix = floor_to_int(fx);
  voxel->iy = floor_to_int(fy);
  voxel->iz = floor_to_int(fz);
  const float dx = fx - static_cast<float>(voxel->ix) - 0.5f, dy = fy - static_cast<float>(voxel->iy) - 0.5f,
              dz = fz - static_cast<float>(voxel->iz) - 0.5f;
  voxel->squared_distance_to_centre = dx * dx + dy * dy + dz * dz;
  return true;
}

std::uint64_t pack(const Voxel& v) {
  return (static_cast<std::uint64_t>(v.ix + (1 << 20)) << 42) |
         (static_cast<std::uint64_t>(v.iy + (1 << 20)) << 21) | static_cast<std::uint64_t>(v.iz + (1 << 20));
}

/// Fibonacci hashing: only the high bits of the product depend on all bits of the key.
std::size_t hash(std::uint64_t key) {
  return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> 32);
}

/// The point nearest to the centre of each voxel, in an open-addressing table whose size grows with the
/// number of voxels, not of points: it stays in cache when many points share few voxels, the case that
/// thinning is used for.
class VoxelTable {
 public:
  VoxelTable() : slots_(kFirstSlots) {}

  void offer(const PointCloud& cloud, std::uint32_t index, const Voxel& voxel) {
    const std::uint64_t key = pack(voxel);
    Slot& slot = find(key);
    if (slot.index == kEmpty) {
      slot = {key, index, voxel.squared_distance_to_centre};
      if (++used_ * 2 > slots_.size()) grow();
    } else if (better(cloud, voxel.squared_distance_to_centre, index, slot)) {
      slot = {key, index, voxel.squared_distance_to_centre};
    }
  }

  /// Indices in Morton order of their voxels.
  std::vector<std::uint32_t> collect() const {
    std::vector<KeyedIndex> order;
    order.reserve(used_);
    for (const Slot& slot : slots_) {
      if (slot.index == kEmpty) continue;
      const auto coordinate = [&](int shift) {
        return static_cast<std::int32_t>((slot.key >> shift) & 0x1fffff) - (1 << 20);
      };
      order.emplace_back(morton_key(coordinate(42), coordinate(21), coordinate(0)), slot.index);
    }
    radix_sort(&order);
    std::vector<std::uint32_t> indices(order.size());
    std::transform(order.begin(), order.end(), indices.begin(),
                   [](const auto& entry) { return entry.second; });
    return indices;
  }

 private:
  static constexpr std::uint32_t kEmpty = 0xffffffffu;
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t index = kEmpty;
    float distance = 0;
  };

  static bool better(const PointCloud& cloud, float distance, std::uint32_t index, const Slot& slot) {
    if (distance != slot.distance) return distance < slot.distance;
    const std::uint32_t other = slot.index;
    if (cloud.x[index] != cloud.x[other]) return cloud.x[index] < cloud.x[other];
    if (cloud.y[index] != cloud.y[other]) return cloud.y[index] < cloud.y[other];
    return cloud.z[index] < cloud.z[other];
  }

  Slot& find(std::uint64_t key) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = hash(key) & mask;
    while (slots_[at].index != kEmpty && slots_[at].key != key) at = (at + 1) & mask;
    return slots_[at];
  }

  void grow() {
    std::vector<Slot> old(slots_.size() * 4);
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.index != kEmpty) find(slot.key) = slot;
    }
  }

  static constexpr std::size_t kFirstSlots = 1u << 13;
  std::vector<Slot> slots_;
  std::size_t used_ = 0;
};

/// Numbers voxels by the order of their first points; an open-addressing table.
class VoxelNumbers {
 public:
  VoxelNumbers() : slots_(1u << 13) {}

  std::uint32_t number(std::uint64_t key) {
    Slot& slot = find(key);
    if (slot.number != kEmpty) return slot.number;
    const std::uint32_t number = static_cast<std::uint32_t>(keys_.size());
    slot = {key, number};
    keys_.push_back(key);
    if (keys_.size() * 2 > slots_.size()) grow();
    return number;
  }
  const std::vector<std::uint64_t>& keys() const { return keys_; }

 private:
  static constexpr std::uint32_t kEmpty = 0xffffffffu;
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t number = kEmpty;
  };
  Slot& find(std::uint64_t key) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = hash(key) & mask;
    while (slots_[at].number != kEmpty && slots_[at].key != key) at = (at + 1) & mask;
    return slots_[at];
  }
  void grow() {
    slots_.assign(slots_.size() * 4, Slot());
    for (std::size_t i = 0; i < keys_.size(); ++i) find(keys_[i]) = {keys_[i], static_cast<std::uint32_t>(i)};
  }

  std::vector<Slot> slots_;
  std::vector<std::uint64_t> keys_;
};

std::uint64_t morton_of(std::uint64_t key) {
  const auto coordinate = [&](int shift) {
    return static_cast<std::int32_t>((key >> shift) & 0x1fffff) - (1 << 20);
  };
  return morton_key(coordinate(42), coordinate(21), coordinate(0));
}

/// Sums over the points of a voxel; points are relative to the first one, to keep float precision far from
/// the origin.
struct VoxelSum {
  Eigen::Vector3f first = Eigen::Vector3f::Zero(), offsets = Eigen::Vector3f::Zero(),
                  normals = Eigen::Vector3f::Zero();
  float count = 0;
};

template <typename IndexAt>
std::vector<std::uint32_t> thin(const PointCloud& cloud, std::size_t n, float size, const IndexAt& index_at) {
  if (!(size > 0)) throw std::invalid_argument("thin_by_voxel: the voxel size must be above 0");
  const float inverse_size = 1.0f / size;
  VoxelTable table;
  Voxel voxel{};
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t index = index_at(i);
    if (locate(cloud.x[index], cloud.y[index], cloud.z[index], inverse_size, &voxel))
      table.offer(cloud, index, voxel);
  }
  return table.collect();
}

}  // namespace

std::uint64_t morton_key(std::int32_t ix, std::int32_t iy, std::int32_t iz) {
  const auto biased = [](std::int32_t v) { return static_cast<std::uint64_t>(v + (1 << 20)); };
  return spread_bits(biased(ix)) | spread_bits(biased(iy)) << 1 | spread_bits(biased(iz)) << 2;
}

Eigen::Vector3i morton_cell(std::uint64_t key) {
  Eigen::Vector3i cell;
  for (int axis = 0; axis < 3; ++axis) cell[axis] = static_cast<int>(gathered_bits(key >> axis)) - (1 << 20);
  return cell;
}

std::vector<std::uint32_t> thin_by_voxel(const PointCloud& cloud, float voxel) {
  return thin(cloud, cloud.size(), voxel, [](std::size_t i) { return static_cast<std::uint32_t>(i); });
}

std::vector<std::uint32_t> thin_by_voxel(const PointCloud& cloud, const std::vector<std::uint32_t>& subset,
                                         float voxel) {
  return thin(cloud, subset.size(), voxel, [&](std::size_t i) { return subset[i]; });
}

void ThinnedCloud::thin() {
  points_ = select(points_, thin_by_voxel(points_, voxel_));
}

void ThinnedCloud::settle() {
  if (points_.size() < most_) return;
  thin();
  most_ = std::max(most_, 2 * points_.size());
}

PointCloud ThinnedCloud::take() {
  thin();
  return std::exchange(points_, {});
}

std::size_t count_voxels(const PointCloud& cloud, float size) {
  if (!(size > 0)) throw std::invalid_argument("count_voxels: the voxel size must be above 0");
  const float inverse_size = 1.0f / size;
  VoxelNumbers voxels;
  Voxel voxel{};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (locate(cloud.x[i], cloud.y[i], cloud.z[i], inverse_size, &voxel)) voxels.number(pack(voxel));
  }
  return voxels.keys().size();
}

PointCloud average_by_voxel(const PointCloud& cloud, float size) {
  if (!(size > 0)) throw std::invalid_argument("average_by_voxel: the voxel size must be above 0");
  const float inverse_size = 1.0f / size;
  const bool normals = cloud.has_normals();
  VoxelNumbers voxels;
  std::vector<VoxelSum> sums;
  Voxel voxel{};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!locate(cloud.x[i], cloud.y[i], cloud.z[i], inverse_size, &voxel)) continue;
    const std::uint32_t number = voxels.number(pack(voxel));
    if (number == sums.size()) {
      sums.emplace_back();
      sums.back().first = cloud.point(i);
    }
    VoxelSum& sum = sums[number];
    sum.offsets += cloud.point(i) - sum.first;
    sum.count += 1;
    if (normals && cloud.normal(i).allFinite())
      sum.normals +=
          sum.normals.dot(cloud.normal(i)) < 0 ? Eigen::Vector3f(-cloud.normal(i)) : cloud.normal(i);
  }
  std::vector<KeyedIndex> order(sums.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = {morton_of(voxels.keys()[i]), static_cast<std::uint32_t>(i)};
  radix_sort(&order);
  PointCloud result;
  result.reserve(order.size());
  for (const auto& entry : order) {
    const VoxelSum& sum = sums[entry.second];
    result.push_back(sum.first + sum.offsets / sum.count);
    if (!normals) continue;
    const Eigen::Vector3f normal = sum.normals.normalized();
    result.nx.push_back(normal.x());
    result.ny.push_back(normal.y());
    result.nz.push_back(normal.z());
  }
  return result;
}

PointCloud select(const PointCloud& cloud, const std::vector<std::uint32_t>& indices) {
  PointCloud result;
  const auto pick = [&](const auto& from, auto* to) {
    if (from.empty()) return;
    to->resize(indices.size());
    for (std::size_t i = 0; i < indices.size(); ++i) (*to)[i] = from[indices[i]];
  };
  pick(cloud.x, &result.x);
  pick(cloud.y, &result.y);
  pick(cloud.z, &result.z);
  pick(cloud.nx, &result.nx);
  pick(cloud.ny, &result.ny);
  pick(cloud.nz, &result.nz);
  pick(cloud.intensity, &result.intensity);
  pick(cloud.time, &result.time);
  pick(cloud.viewpoints, &result.viewpoints);
  pick(cloud.alone, &result.alone);
  return result;
}

}  // namespace scanlock
