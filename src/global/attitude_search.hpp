// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "global/max_consensus.hpp"

namespace scanlock {

inline constexpr int kFewestMatches = 8;     // consensus below which nothing is believed
inline constexpr double kClearMargin = 1.3;  // of the consensus over its runner-up

/// Directions of the target's frame that may be the source's z axis: where none are given, the z axis.
inline std::vector<Eigen::Vector3d> ups_or_z(const std::vector<Eigen::Vector3d>& ups) {
  return ups.empty() ? std::vector<Eigen::Vector3d>{Eigen::Vector3d::UnitZ()} : ups;
}

/// The unit direction in their middle; where there is none, as of opposite ones, one of them. Empty: z.
Eigen::Vector3d middle_of(const std::vector<Eigen::Vector3d>& ups);

/// register_matches() for each direction of the target's frame that may be the source's z axis, as one
/// search: the largest consensus of all, with an upper bound that holds for all. The runner-up, and its
/// bound, are those in the attitude of the best pose, or better ones that were met elsewhere. Without
/// directions: the z axis, and any consensus; else those below kFewestMatches or `search.at_least`, and those
/// far below one that is known, are not searched out. `search.max_work` is that of all of them.
/// `centre`: of the source, metres. `search.up` is the z axis.
MatchRegistration search_attitudes(const Matches& matches, MatchRegistrationOptions search,
                                   const std::vector<Eigen::Vector3d>& target_ups,
                                   const Eigen::Vector3d& centre);

}  // namespace scanlock
