// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace scanlock {

using KeyedIndex = std::pair<std::uint64_t, std::uint32_t>;

/// Stable sort by key; the time is linear in the number of entries and in the number of digits in which the
/// keys differ.
inline void radix_sort(std::vector<KeyedIndex>* entries) {
  constexpr int kBits = 11;
  constexpr std::uint64_t kMask = (1u << kBits) - 1;
  std::uint64_t any = 0, all = ~std::uint64_t{0};
  for (const KeyedIndex& entry : *entries) {
    any |= entry.first;
    all &= entry.first;
  }
  std::vector<KeyedIndex> other(entries->size());
  for (int shift = 0; shift < 64; shift += kBits) {
    if (((any ^ all) >> shift & kMask) == 0) continue;
    std::array<std::uint32_t, kMask + 1> begin{};
    for (const KeyedIndex& entry : *entries) ++begin[entry.first >> shift & kMask];
    std::uint32_t sum = 0;
    for (std::uint32_t& count : begin) sum += std::exchange(count, sum);
    for (const KeyedIndex& entry : *entries) other[begin[entry.first >> shift & kMask]++] = entry;
    entries->swap(other);
  }
}

}  // namespace scanlock
