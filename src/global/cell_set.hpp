// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace scanlock {

/// A set of 64-bit keys (2^64 - 1 is not allowed): open addressing, at most half full.
class CellSet {
 public:
  std::size_t size() const { return size_; }

  bool contains(std::uint64_t key) const {
    std::size_t at = place(key);
    while (slots_[at] != key && slots_[at] != kEmpty) at = (at + 1) & (slots_.size() - 1);
    return slots_[at] == key;
  }

  void insert(std::uint64_t key) {
    std::size_t at = place(key);
    while (slots_[at] != key && slots_[at] != kEmpty) at = (at + 1) & (slots_.size() - 1);
    if (slots_[at] == key) return;
    slots_[at] = key;
    if (2 * ++size_ > slots_.size()) grow();
  }

 private:
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};

  std::size_t place(std::uint64_t key) const {
    return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15u) >> shift_);  // Fibonacci hashing
  }
  void grow() {
    std::vector<std::uint64_t> old(2 * slots_.size(), kEmpty);
    old.swap(slots_);
    --shift_;
    size_ = 0;
    for (const std::uint64_t key : old) {
      if (key != kEmpty) insert(key);
    }
  }

  int shift_ = 64 - 12;
  std::size_t size_ = 0;
  std::vector<std::uint64_t> slots_ = std::vector<std::uint64_t>(std::size_t{1} << 12, kEmpty);
};

}  // namespace scanlock
