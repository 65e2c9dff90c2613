// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/runner_up.hpp"

#include <algorithm>

namespace scanlock {

void seek_runner_up(const LevelMatches& matches, const LevelPose& first,
                    const MatchRegistrationOptions& options, const LevelFrame& frame, SearchLimits limits,
                    MatchRegistration& result) {
  constexpr std::size_t kLeastWork = 200'000, kMostWork = 4'000'000;
  const std::size_t work = limits.work;
  const ExcludedPoses excluded{first, options.runner_up_angle, options.runner_up_distance};
  Incumbent runner_up;
  int bound = result.upper_bound;
  bool finished = false;
  if (options.weak_runner_up) {
    limits.work = std::min(work, kLeastWork);
    const SearchResult quick = search_poses(matches, runner_up, limits, excluded);
    bound = quick.upper_bound;
    finished = quick.finished;
  }
  if (!finished) {
    Incumbent better = runner_up;
    better.consensus = std::max(runner_up.consensus, result.consensus / 2);
    const int known = better.consensus;
    limits.work = std::min(work, std::max(kMostWork, 2 * result.work));
    bound = std::min(bound, search_poses(matches, better, limits, excluded).upper_bound);
    if (better.consensus > known) runner_up = better;
  }
  result.runner_up = frame.pose(runner_up.pose);
  result.runner_up_consensus = runner_up.consensus;
  result.runner_up_bound = std::min(bound, result.upper_bound);
}

}  // namespace scanlock
