// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace scanlock {

/// Hash map from the key of a voxel to the index of a point in it; open addressing, for speed: it is queried
/// for every point of every keyframe.
class VoxelIndex {
 public:
  VoxelIndex() : slots_(kFirstSlots) {}

  /// The slots stay allocated, for about as many voxels again.
  void clear() {
    std::fill(slots_.begin(), slots_.end(), Slot{});
    used_ = 0;
  }

  /// Returns the point that represents the voxel; that is `point` from now on where there was none.
  std::uint32_t insert(std::uint64_t key, std::uint32_t point) {
    Slot& slot = slots_[find(key)];
    if (slot.key == key) return slot.point;
    slot = {key, point};
    if (++used_ * 2 > slots_.size()) grow();
    return point;
  }
  /// Voxels represented by point i are represented by point now[i] from now on, by none where that is kGone.
  static constexpr std::uint32_t kGone = ~0U;
  void renumber(const std::vector<std::uint32_t>& now) {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      while (slots_[i].key != Slot().key && now[slots_[i].point] == kGone) erase(i);
    }
    for (Slot& slot : slots_) {
      if (slot.key != Slot().key) slot.point = now[slot.point];
    }
  }
  std::optional<std::uint32_t> at(std::uint64_t key) const {
    const Slot& slot = slots_[find(key)];
    return slot.key == key ? std::optional<std::uint32_t>(slot.point) : std::nullopt;
  }

 private:
  struct Slot {
    std::uint64_t key = ~0ULL;  // none: a Morton key has 63 bits
    std::uint32_t point = 0;
  };
  static constexpr std::size_t kFirstSlots = 1u << 14;

  std::size_t mask() const { return slots_.size() - 1; }
  std::size_t home(std::uint64_t key) const {
    return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> 32) & mask();
  }
  std::size_t find(std::uint64_t key) const {
    std::size_t at = home(key);
    while (slots_[at].key != Slot().key && slots_[at].key != key) at = (at + 1) & mask();
    return at;
  }

  /// Fills the hole with the next slot of its run that may be stored there, then the hole that this leaves,
  /// etc.
  void erase(std::size_t hole) {
    for (std::size_t i = (hole + 1) & mask(); slots_[i].key != Slot().key; i = (i + 1) & mask()) {
      const bool is_before_home = ((i - home(slots_[i].key)) & mask()) < ((i - hole) & mask());
      if (is_before_home) continue;
      slots_[hole] = slots_[i];
      hole = i;
    }
    slots_[hole] = {};
    --used_;
  }

  void grow() {
    std::vector<Slot> old(slots_.size() * 2);
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.key != Slot().key) slots_[find(slot.key)] = slot;
    }
  }

  std::vector<Slot> slots_;
  std::size_t used_ = 0;
};

}  // namespace scanlock
