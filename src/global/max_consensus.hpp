// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "geometry/match.hpp"
#include "geometry/rigid.hpp"

namespace scanlock {

/// How to register a match set. Only budget_s ends a search by time; with the limits max_nodes and max_work
/// the result is deterministic.
struct MatchRegistrationOptions {
  double epsilon = 0.1;                           ///< metres: |R p + t - q| <= epsilon is an inlier
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< the axis of rotation, any length but 0
  double tilt = 0;                                ///< radians, see register_matches()
  bool prune = true;                              ///< prune the match set before the search
  double budget_s = std::numeric_limits<double>::infinity();  ///< wall-clock seconds
  std::size_t max_nodes = std::numeric_limits<std::size_t>::max();
  std::size_t max_work = std::numeric_limits<std::size_t>::max();  ///< matches visited, some 20 ns each
  /// Least consensus of interest: if no pose is found that holds so many matches, the consensus is 0, and the
  /// upper bound is at_least - 1 if it is proven that there is none.
  int at_least = 0;
  /// Called repeatedly with the consensus so far and its upper bound, for a progress bar; may be empty.
  std::function<void(int consensus, int upper_bound)> progress;
  bool runner_up = true;            ///< search for the runner-up
  bool weak_runner_up = true;       ///< also, with little effort, for one of less than half the consensus
  double runner_up_distance = 1.0;  ///< metres, at the centre of the source points
  double runner_up_angle = 0.0872664625997164788;  ///< radians
};

/// The pose that holds the most matches, and the proven bounds.
struct MatchRegistration {
  Pose target_from_source = Pose::Identity();
  int consensus = 0;       ///< matches that the pose holds
  int upper_bound = 0;     ///< no levelled pose holds more
  bool certified = false;  ///< upper_bound == consensus

  /// The best pose found that differs from the first by more than runner_up_distance or runner_up_angle.
  Pose runner_up = Pose::Identity();
  int runner_up_consensus = 0;
  int runner_up_bound =
      0;  ///< no such pose holds more; not tightened below half the consensus, and with bounded effort

  std::vector<std::uint32_t> inliers;  ///< of target_from_source, ascending
  std::size_t matches = 0, matches_after_pruning = 0, nodes = 0, work = 0;  ///< work: matches visited
  double pruning_ms = 0, search_ms = 0, runner_up_ms = 0;                   ///< CPU time of this thread
};

/// Maximum consensus registration of levelled point clouds from candidate matches (Cai et al., equation 3;
/// Algorithm 1 without its first line): the rotation about `up` and the translation that hold the most
/// matches, with a certificate. Uses one thread; deterministic unless budget_s ends the search.
///
/// Tilt: if the up axis of each cloud is known only to `tilt`, the threshold of a match is epsilon plus the
/// displacement of p by two such tilts about the centre of the source points, 4 sin(tilt / 2) |p - centre|.
/// The meaning of the certificate is then: no rigid motion whose up axes are within `tilt` of `up` in both
/// clouds holds more than upper_bound matches within epsilon.
///
/// Throws std::invalid_argument with a sentence when an option is out of range or a coordinate is not finite
/// or beyond 1e9 m (naming the match, counted from 0). Without matches the consensus is 0, certified.
MatchRegistration register_matches(const Matches& matches, const MatchRegistrationOptions& options = {});

/// Searches for the runner-up of a certified registration of the same matches that was made without that
/// search, and adds it to `registration`.
void find_runner_up(const Matches& matches, const MatchRegistrationOptions& options,
                    MatchRegistration* registration);

}  // namespace scanlock
