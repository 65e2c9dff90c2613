// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/voxel_index.hpp"

#include <doctest/doctest.h>

#include <map>
#include <random>

namespace scanlock {

TEST_CASE("a voxel index behaves as a std::map, also after points were removed and renumbered") {
  std::mt19937 random(3);
  VoxelIndex index;
  std::map<std::uint64_t, std::uint32_t> judge;
  std::uint32_t points = 0;
  for (int round = 0; round < 6; ++round) {
    CAPTURE(round);
    for (int i = 0; i < 30000; ++i) {  // near each other, as in a scene, so that runs of slots are long
      const std::uint64_t key = random() % 200000;
      const auto [at, is_new] = judge.insert({key, points});
      CHECK(index.insert(key, points) == at->second);
      if (is_new) ++points;
    }
    std::vector<std::uint32_t> now(points, VoxelIndex::kGone);
    std::uint32_t left = 0;
    for (std::uint32_t& number : now)
      if (random() % 4 != 0) number = left++;
    index.renumber(now);
    points = left;
    std::map<std::uint64_t, std::uint32_t> stay;
    for (const auto& [key, point] : judge)
      if (now[point] != VoxelIndex::kGone) stay[key] = now[point];
    judge.swap(stay);
    std::size_t wrong = 0;
    for (std::uint64_t key = 0; key < 200000; ++key) {
      const auto at = judge.find(key);
      wrong += index.at(key) != (at == judge.end() ? std::nullopt : std::optional(at->second));
    }
    CHECK(wrong == 0);
  }
  index.clear();
  CHECK_FALSE(index.at(judge.begin()->first));
}

}  // namespace scanlock
