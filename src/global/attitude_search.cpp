// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/attitude_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "global/hypothesis.hpp"

namespace scanlock {
namespace {

/// The matches with their target points rotated.
Matches turned(Matches matches, const Eigen::Matrix3d& rotation) {
  for (Match& match : matches) match.q = rotation * match.q;
  return matches;
}

/// Removes and returns the unit vector nearest to `direction`, which may have any length.
Eigen::Vector3d take_nearest(const Eigen::Vector3d& direction, std::vector<Eigen::Vector3d>* from) {
  const auto nearest = std::max_element(from->begin(), from->end(), [&](const auto& a, const auto& b) {
    return a.dot(direction) < b.dot(direction);
  });
  const Eigen::Vector3d result = *nearest;
  from->erase(nearest);
  return result;
}

void turn(const Eigen::Matrix3d& rotation, MatchRegistration* found) {
  for (Pose* pose : {&found->target_from_source, &found->runner_up}) *pose = rotation * *pose;
}

MatchRegistration search_attitude(const Matches& matches, const MatchRegistrationOptions& search,
                                  const Eigen::Vector3d& up) {
  const Eigen::Matrix3d level = level_rotation(up);
  MatchRegistration found = register_matches(turned(matches, level), search);
  turn(level.transpose(), &found);
  return found;
}

void add_runner_up(const Matches& matches, const MatchRegistrationOptions& search, const Eigen::Vector3d& up,
                   MatchRegistration* found) {
  const Eigen::Matrix3d level = level_rotation(up);
  turn(level, found);
  find_runner_up(turned(matches, level), search, found);
  turn(level.transpose(), found);
}

/// Merges the search of another attitude into the best one: its upper bound, and its pose as the runner-up
/// where that holds more matches than the runner-up so far and is a different hypothesis.
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
}

void add_effort(const MatchRegistration& of, MatchRegistration* sum) {
  sum->nodes += of.nodes;
  sum->work += of.work;
  sum->pruning_ms += of.pruning_ms;
  sum->search_ms += of.search_ms;
  sum->runner_up_ms += of.runner_up_ms;
}

}  // namespace

Eigen::Vector3d middle_of(const std::vector<Eigen::Vector3d>& ups) {
  constexpr double kNone = 1e-6;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& up : ups) sum += up.normalized();
  return sum.norm() > kNone ? Eigen::Vector3d(sum.normalized()) : ups_or_z(ups).front().normalized();
}

MatchRegistration search_attitudes(const Matches& matches, MatchRegistrationOptions search,
                                   const std::vector<Eigen::Vector3d>& target_ups,
                                   const Eigen::Vector3d& centre) {
  if (target_ups.empty() || matches.empty()) return register_matches(matches, search);
  const int fewest = std::max(kFewestMatches, search.at_least);
  const bool runner_up = search.runner_up;
  search.runner_up = false;  // only for the best attitude: this search takes longer than that for the pose
  std::vector<Eigen::Vector3d> left = target_ups;
  Eigen::Vector3d best_up = middle_of(target_ups);
  std::vector<MatchRegistration> found;
  std::size_t best = 0;
  // The direction nearest to the best one so far is searched next: the sooner a large consensus is found, the
  // more can be pruned.
  while (!left.empty()) {
    const Eigen::Vector3d up = take_nearest(best_up, &left);
    // A smaller consensus than the best one is of interest only for a runner-up.
    const int most = found.empty() ? 0 : found[best].consensus;
    const double wanted = runner_up ? most / kClearMargin : most + 1;
    search.at_least = std::max(fewest, static_cast<int>(std::ceil(wanted)));
    if (search.max_work == 0) {  // the remaining directions were not searched: no bound holds for them
      MatchRegistration unknown;
      unknown.upper_bound = static_cast<int>(matches.size());
      found.push_back(unknown);
      break;
    }
    found.push_back(search_attitude(matches, search, up));
    search.max_work -= std::min(search.max_work, found.back().work);
    if (found.back().consensus <= most) continue;
    best = found.size() - 1;
    best_up = up;
  }
  MatchRegistration result = found[best];
  if (runner_up && result.certified) add_runner_up(matches, search, best_up, &result);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (k == best) continue;
    merge(found[k], centre, search.epsilon, &result);
    add_effort(found[k], &result);
  }
  return result;
}

}  // namespace scanlock
