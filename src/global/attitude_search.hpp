// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "global/max_consensus.hpp"

namespace scanlock {

inline constexpr int kFewestMatches = 8;     // matches: no smaller consensus is evidence of a pose
inline constexpr double kClearMargin = 1.3;  // least ratio of a clear consensus to that of its runner-up

/// The given directions of the target's frame that may be the source's z axis; the z axis if none are given.
inline std::vector<Eigen::Vector3d> ups_or_z(const std::vector<Eigen::Vector3d>& ups) {
  return ups.empty() ? std::vector<Eigen::Vector3d>{Eigen::Vector3d::UnitZ()} : ups;
}

/// The mean direction, of unit length; the first direction where the mean is zero, as for opposite
/// directions; the z axis if none are given.
Eigen::Vector3d middle_of(const std::vector<Eigen::Vector3d>& ups);

/// register_matches() for each direction of the target's frame that may be the source's z axis, as one
/// search: returns the largest consensus over all directions, with an upper bound that holds for all. The
/// runner-up and its bound are those in the attitude of the best pose, or a better one found in another
/// attitude. Without directions, the z axis and any consensus. With directions, a consensus below
/// kFewestMatches or `search.at_least`, or too small for the best pose or its runner-up, is not searched to
/// its proof. `search.max_work` limits the sum over all directions. `centre`: of the source, metres.
/// `search.up` has to be the z axis.
MatchRegistration search_attitudes(const Matches& matches, MatchRegistrationOptions search,
                                   const std::vector<Eigen::Vector3d>& target_ups,
                                   const Eigen::Vector3d& centre);

}  // namespace scanlock
