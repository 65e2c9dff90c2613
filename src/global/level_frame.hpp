// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/match.hpp"
#include "geometry/rigid.hpp"
#include "global/matches.hpp"
#include "global/max_consensus.hpp"

namespace scanlock {

/// Throws what register_matches() throws.
void check_input(const Matches& matches, const MatchRegistrationOptions& options);

/// From the caller's coordinates to the solver's: z up, both sides about their centres.
struct LevelFrame {
  Eigen::Matrix3d level = Eigen::Matrix3d::Identity();  ///< turns `up` to z
  Eigen::Vector3d p_centre = Eigen::Vector3d::Zero(),
                  q_centre = Eigen::Vector3d::Zero();  ///< in the caller's axes

  LevelFrame(const Matches& matches, const Eigen::Vector3d& up);
  Pose pose(const LevelPose& found) const;
  LevelPose level_pose(const Pose& pose) const;
  /// The matches as the solver sees them, with their thresholds.
  LevelMatches levelled(const Matches& matches, const MatchRegistrationOptions& options) const;
};

}  // namespace scanlock
