// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// Algorithms 2 and 3 of Practical optimal registration of terrestrial LiDAR scan pairs (Cai, Chin, Parra
// Bustos, Schindler), as one search. A comment "2: 4" names the printed algorithm and line; README.md says
// what differs and why.
#include "global/branch_and_bound.hpp"

#include <algorithm>

#include "global/pose_search.hpp"

namespace scanlock {

SearchResult PoseSearch::run() {
  if (m_.size() > 0) {
    measure();
    open_slabs();  // 2: 1, 2. All poses that hold any match
    if (!excluded_ && (pruning_ || answer_.consensus() == 0)) seed();
  }
  // 2: 3, 6. Once the highest bound does not exceed the incumbent, "prune w" would remove all nodes.
  while (!open_.empty() && open_.highest_bound() >= wanted()) {
    if (out_of_budget()) {
      result_.upper_bound = std::max({result_.upper_bound, open_.highest_bound(), answer_.consensus()});
      return result_;
    }
    constexpr std::size_t kNodesBetweenReports = 1024;
    if (limits_.progress && result_.nodes % kNodesBetweenReports == 0)
      limits_.progress(answer_.consensus(), open_.highest_bound());
    Node node = open_.pop();  // 2: 4
    ++result_.nodes;
    switch (node.kind) {  // 2: 7, 8, and 5, 6 for the centre of each new box
      case NodeKind::kSlab:
        divide_slab(node);
        break;
      case NodeKind::kSector:
        divide_sector(node);
        break;
      case NodeKind::kBox:
        divide_box(node);
        break;
    }
  }
  result_.finished = result_.upper_bound <= answer_.consensus();
  result_.upper_bound = std::max(result_.upper_bound, answer_.consensus());
  return result_;
}

bool PoseSearch::out_of_budget() const {
  return result_.nodes >= limits_.nodes || result_.work >= limits_.work ||
         open_.entries() > limits_.list_entries || std::chrono::steady_clock::now() > limits_.deadline;
}

SearchResult search_poses(const LevelMatches& matches, Incumbent& best, const SearchLimits& limits,
                          const std::optional<ExcludedPoses>& excluded) {
  return PoseSearch(matches, best, limits, excluded, false).run();
}

SearchResult prune_matches(const LevelMatches& matches, Incumbent& best, std::vector<std::uint32_t>& kept,
                           const SearchLimits& limits) {
  const std::optional<ExcludedPoses> none;
  PoseSearch search(matches, best, limits, none, true);
  const SearchResult result = search.run();
  kept.clear();  // 3: 10, 11
  if (result.finished) {
    kept = search.kept();
  } else {
    for (std::uint32_t i = 0; i < matches.size(); ++i) kept.push_back(i);
  }
  return result;
}

}  // namespace scanlock
