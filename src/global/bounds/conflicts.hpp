// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "global/matches.hpp"

namespace scanlock {

/// Proves that matches have no common pose. For any weights that sum to 1, the weighted mean of the squared
/// residuals (in units of the squared thresholds) is at most their maximum, and its minimum over all levelled
/// poses has a closed form, the weighted fit: if that exceeds 1, no pose holds all the matches. Lawson's
/// iteration, which multiplies the weights by the residuals repeatedly, raises the mean towards the minimum
/// over poses of the maximum, so that the result is a proof, or a pose, or a tie within rounding.
class Conflicts {
 public:
  explicit Conflicts(const LevelMatches& matches) : m_(matches) {}

  /// True if it is proven that no pose holds all matches of `list` except at most `drops`: a pose misses at
  /// least one match of each conflict, so that each match of a small conflict is left out in turn. Returns
  /// false if `iterations` of the weights find neither a conflict nor a pose. Poses that are found raise the
  /// incumbent.
  bool infeasible(const std::vector<std::uint32_t>& list, int drops, int iterations, Incumbent& best);

 private:
  enum class Verdict { kConflict, kPose, kUndecided };
  struct Weighted {
    std::vector<std::uint32_t> matches;
    std::vector<double> weights;  // sum 1
  };
  double weighted_mean(const Weighted& set, std::size_t size, LevelPose& pose);
  Verdict weigh(Weighted& set, int iterations, Incumbent& best);
  void touch(const Weighted& set, LevelPose& pose) const;
  std::size_t small_conflict(Weighted& set);
  bool infeasible(Weighted set, int drops, int iterations, Incumbent& best);

  const LevelMatches& m_;
  std::vector<double> fit_weights_, squares_;
};

}  // namespace scanlock
