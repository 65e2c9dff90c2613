// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/cell_set.hpp"

#include <doctest/doctest.h>

#include <random>
#include <set>

using namespace scanlock;

TEST_CASE("A set of cells contains exactly the inserted cells") {
  std::mt19937_64 random(3);
  CellSet cells;
  std::set<std::uint64_t> known;
  for (int i = 0; i < 50000; ++i) {
    const std::uint64_t key = random() % 30000 << (i % 40);  // many keys repeat, and so do the low bits
    cells.insert(key);
    known.insert(key);
  }
  CHECK(cells.size() == known.size());
  int wrong = 0;
  for (const std::uint64_t key : known) wrong += cells.contains(key) ? 0 : 1;
  for (int i = 0; i < 50000; ++i) {
    const std::uint64_t key = random() >> 8;
    wrong += cells.contains(key) == (known.count(key) > 0) ? 0 : 1;
  }
  CHECK(wrong == 0);
}
