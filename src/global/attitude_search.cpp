// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/attitude_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "global/hypothesis.hpp"

namespace scanlock {
namespace {

/// The same matches with the targets turned.
Matches turned(Matches matches, const Eigen::Matrix3d& rotation) {
  for (Match& match : matches) match.q = rotation * match.q;
  return matches;
}

/// What the loser leaves open, where it would rather be, and what it took.
void merge(const MatchRegistration& loser, const Eigen::Vector3d& centre, double epsilon,
           MatchRegistration* best) {
  best->upper_bound = std::max(best->upper_bound, loser.upper_bound);
  best->certified = best->consensus > 0 && best->upper_bound == best->consensus;
  if (loser.consensus > best->runner_up_consensus &&
      separation(loser.target_from_source, best->target_from_source, centre, epsilon) >= 1) {
    best->runner_up = loser.target_from_source;
    best->runner_up_consensus = loser.consensus;
    best->runner_up_bound = std::max(best->runner_up_bound, loser.upper_bound);
  }
  best->nodes += loser.nodes;
  best->pruning_ms += loser.pruning_ms;
  best->search_ms += loser.search_ms;
  best->runner_up_ms += loser.runner_up_ms;
}

}  // namespace

MatchRegistration search_attitudes(const Matches& matches, MatchRegistrationOptions search,
                                   const std::vector<Eigen::Vector3d>& target_ups,
                                   const Eigen::Vector3d& centre) {
  if (target_ups.empty() || matches.empty()) return register_matches(matches, search);
  MatchRegistration best;
  best.matches = matches.size();
  for (const Eigen::Vector3d& up : target_ups) {
    const Eigen::Matrix3d level = level_rotation(up);
    // What loses is of interest only as a runner-up.
    const double wanted = search.runner_up ? best.consensus / kClearMargin : best.consensus + 1;
    search.at_least = std::max(kFewestMatches, static_cast<int>(std::ceil(wanted)));
    MatchRegistration found = register_matches(turned(matches, level), search);
    for (Pose* pose : {&found.target_from_source, &found.runner_up}) *pose = level.transpose() * *pose;
    if (found.consensus > best.consensus) std::swap(found, best);
    merge(found, centre, search.epsilon, &best);
  }
  return best;
}

}  // namespace scanlock
