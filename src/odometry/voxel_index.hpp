// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace scanlock {

/// Hash map from voxel to a point in it; open addressing, for speed: it is asked for every point of every
/// keyframe.
class VoxelIndex {
 public:
  VoxelIndex() { clear(); }

  void clear() {
    slots_.assign(kFirstSlots, {});
    used_ = 0;
  }

  /// The point that stands for the voxel; `point` from now on, where there was none.
  std::uint32_t insert(std::uint64_t key, std::uint32_t point) {
    Slot& slot = slots_[find(key)];
    if (slot.key == key) return slot.point;
    slot = {key, point};
    if (++used_ * 2 > slots_.size()) grow();
    return point;
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

  std::size_t find(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> 32) & mask;
    while (slots_[at].key != Slot().key && slots_[at].key != key) at = (at + 1) & mask;
    return at;
  }

  void grow() {
    std::vector<Slot> old(slots_.size() * 4);
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.key != Slot().key) slots_[find(slot.key)] = slot;
    }
  }

  std::vector<Slot> slots_;
  std::size_t used_ = 0;
};

}  // namespace scanlock
