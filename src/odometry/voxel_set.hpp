// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

namespace scanlock {

/// A set of voxel keys: open addressing, for it is asked for every point of every keyframe.
class VoxelSet {
 public:
  VoxelSet() { clear(); }

  void clear() {
    keys_.assign(kFirstSlots, kEmpty);
    used_ = 0;
  }

  /// False when the key was there already.
  bool insert(std::uint64_t key) {
    std::uint64_t& slot = find(key);
    if (slot == key) return false;
    slot = key;
    if (++used_ * 2 > keys_.size()) grow();
    return true;
  }

 private:
  static constexpr std::uint64_t kEmpty = ~0ULL;  // a Morton key has 63 bits
  static constexpr std::size_t kFirstSlots = 1u << 14;

  std::uint64_t& find(std::uint64_t key) {
    const std::size_t mask = keys_.size() - 1;
    std::size_t at = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> 32) & mask;
    while (keys_[at] != kEmpty && keys_[at] != key) at = (at + 1) & mask;
    return keys_[at];
  }

  void grow() {
    std::vector<std::uint64_t> old(keys_.size() * 4, kEmpty);
    old.swap(keys_);
    for (std::uint64_t key : old) {
      if (key != kEmpty) find(key) = key;
    }
  }

  std::vector<std::uint64_t> keys_;
  std::size_t used_ = 0;
};

}  // namespace scanlock
