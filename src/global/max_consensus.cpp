// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// Algorithm 1 of Practical optimal registration of terrestrial LiDAR scan pairs (Cai, Chin, Parra Bustos,
// Schindler) from its second line on; the first, the match set C of two clouds, is in cloud_description.cpp.
// A comment "1: 2" names the printed algorithm and line; README.md says what differs and why.
#include "global/max_consensus.hpp"

#include <algorithm>
#include <chrono>

#include "global/branch_and_bound.hpp"
#include "global/cpu_clock.hpp"
#include "global/level_frame.hpp"
#include "global/runner_up.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

SearchLimits limits_of(const MatchRegistrationOptions& options) {
  SearchLimits limits;
  limits.nodes = options.max_nodes;
  limits.work = options.max_work;
  limits.progress = options.progress;
  constexpr double kForever = 1e9;
  if (options.budget_s < kForever) {
    limits.deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                         std::chrono::duration<double>(options.budget_s));
  }
  return limits;
}

}  // namespace

MatchRegistration register_matches(const Matches& matches, const MatchRegistrationOptions& options) {
  check_input(matches, options);
  MatchRegistration result;
  result.matches = result.matches_after_pruning = matches.size();
  if (matches.empty()) {
    result.certified = true;
    return result;
  }
  SearchLimits limits = limits_of(options);
  CpuClock clock;
  const LevelFrame frame(matches, options.up);
  const LevelMatches all = frame.levelled(matches, options);
  LevelMatches pruned;
  const LevelMatches* left = &all;
  Incumbent best;
  best.consensus = std::max(0, options.at_least - 1);
  int bound = static_cast<int>(matches.size());
  if (options.prune) {  // 1: 2. Prune C into C'
    std::vector<std::uint32_t> kept;
    const SearchResult pruning = prune_matches(all, best, kept, limits);
    pruned = select(all, kept);
    left = &pruned;
    result.nodes += pruning.nodes;
    result.work += pruning.work;
    limits.nodes -= std::min(limits.nodes, pruning.nodes);
    limits.work -= std::min(limits.work, pruning.work);
    if (!pruning.finished) bound = pruning.upper_bound;
    result.matches_after_pruning = kept.size();
  }
  (options.prune ? result.pruning_ms : result.search_ms) = clock.lap();
  // 1: 3. Solve (4) on C', from the pose that pruning has found.
  const SearchResult search = search_poses(*left, best, limits);
  result.work += search.work;
  result.nodes += search.nodes;
  result.upper_bound = std::max(best.consensus, std::min(bound, search.upper_bound));
  if (best.consensus < options.at_least) {
    result.search_ms += clock.lap();
    return result;
  }
  // 1: 4. theta*, t*, and the certificate. The inliers are counted over C.
  result.consensus = best.consensus;
  result.certified = result.upper_bound == result.consensus;
  result.target_from_source = frame.pose(best.pose);
  for (const std::uint32_t i : inliers(all, best.pose)) result.inliers.push_back(all.original[i]);
  std::sort(result.inliers.begin(), result.inliers.end());
  result.search_ms += clock.lap();
  if (options.runner_up && search.finished) {
    limits.nodes -= std::min(limits.nodes, search.nodes);
    limits.work -= std::min(limits.work, search.work);
    seek_runner_up(all, best.pose, options, frame, limits, result);
  } else {
    result.runner_up_bound = result.upper_bound;
  }
  result.runner_up_ms = clock.lap();
  return result;
}

void find_runner_up(const Matches& matches, const MatchRegistrationOptions& options,
                    MatchRegistration* registration) {
  check_input(matches, options);
  if (matches.empty()) return;
  CpuClock clock;
  const LevelFrame frame(matches, options.up);
  seek_runner_up(frame.levelled(matches, options), frame.level_pose(registration->target_from_source),
                 options, frame, limits_of(options), *registration);
  registration->runner_up_ms += clock.lap();
}

}  // namespace scanlock
