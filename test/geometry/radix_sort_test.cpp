// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/radix_sort.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>

using namespace scanlock;

TEST_CASE("radix sort is a stable sort by key") {
  std::mt19937_64 random(1);
  for (const std::uint64_t mask : {0ull, 0x7ull, 0x3fffffffull, ~0ull, 0xff00000000000fffull}) {
    for (const std::size_t n : {0u, 1u, 2u, 5000u}) {
      std::vector<KeyedIndex> entries;
      for (std::size_t i = 0; i < n; ++i)
        entries.emplace_back((random() & mask) | 0x100ull, static_cast<std::uint32_t>(i));
      std::vector<KeyedIndex> expected = entries;
      std::stable_sort(expected.begin(), expected.end(),
                       [](const KeyedIndex& a, const KeyedIndex& b) { return a.first < b.first; });
      radix_sort(&entries);
      CHECK(entries == expected);
    }
  }
}
