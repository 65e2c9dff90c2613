// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>

#include "global/bounds/pose_box.hpp"
#include "global/matches.hpp"

namespace scanlock {

/// Limits that end a search before its proof.
struct SearchLimits {
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
  std::size_t nodes = std::numeric_limits<std::size_t>::max();
  std::size_t work = std::numeric_limits<std::size_t>::max();  ///< matches visited
  std::size_t list_entries = 100'000'000;                      ///< match indices in open nodes, 4 bytes each
  std::function<void(int consensus, int upper_bound)> progress;  ///< called repeatedly, unless empty
};

struct SearchResult {
  int upper_bound = 0;  ///< no pose that is not excluded holds more matches
  bool finished = false;
  std::size_t nodes = 0, work = 0;
};

/// Best-first branch and bound over levelled poses (Algorithm 2, over all four axes): slabs of height,
/// divided into sectors of angle that are bounded by votes, then into boxes, each of which inherits the match
/// list of the box that it is a part of. Raises the incumbent `best`. If finished, upper_bound ==
/// best.consensus.
SearchResult search_poses(const LevelMatches& matches, Incumbent& best, const SearchLimits& limits = {},
                          const std::optional<ExcludedPoses>& excluded = std::nullopt);

/// Fast match pruning (the rule of Algorithm 3, with bounds of boxes of poses shared by all matches instead
/// of one bound per match): drops a match only when each box of poses that can hold it has a bound strictly
/// below the incumbent's consensus, so that every pose of largest consensus keeps all its inliers (Lemma 2).
/// Raises the incumbent `best`. `kept`: indices, ascending; all matches if the search is not finished.
SearchResult prune_matches(const LevelMatches& matches, Incumbent& best, std::vector<std::uint32_t>& kept,
                           const SearchLimits& limits = {});

}  // namespace scanlock
