// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "global/bounds/pose_box.hpp"
#include "global/matches.hpp"

namespace scanlock {

/// The result of a search so far: the best pose and, for a search that prunes, the matches to keep.
class SearchAnswer {
 public:
  /// Raises `best`; all arguments have to outlive it.
  SearchAnswer(const LevelMatches& matches, Incumbent& best, const std::optional<ExcludedPoses>& excluded,
               bool pruning);

  const Incumbent& best() const { return best_; }
  int consensus() const { return best_.consensus; }
  /// The smallest upper bound for which a set of poses still has to be searched.
  int wanted() const;
  /// Offers a pose that holds at least `count` matches, and a pose climbed and polished from the matches
  /// `held`; returns true if the best pose improved.
  bool offer(const LevelPose& pose, int count, const std::vector<std::uint32_t>& held);
  void keep(const std::vector<std::uint32_t>& matches);
  bool all_kept(const std::vector<std::uint32_t>& matches) const;
  std::vector<std::uint32_t> kept() const;  ///< ascending

 private:
  const LevelMatches& m_;
  Incumbent& best_;
  const std::optional<ExcludedPoses>& excluded_;
  const bool pruning_;
  std::vector<std::uint8_t> kept_;
};

}  // namespace scanlock
