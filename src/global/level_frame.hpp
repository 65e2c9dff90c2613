// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/match.hpp"
#include "geometry/rigid.hpp"
#include "global/matches.hpp"
#include "global/max_consensus.hpp"

namespace scanlock {

/// Throws the exceptions of register_matches().
void check_input(const Matches& matches, const MatchRegistrationOptions& options);

/// Converts from the caller's coordinates to the solver's: z up, source and target points relative to their
/// centres.
struct LevelFrame {
  Eigen::Matrix3d level = Eigen::Matrix3d::Identity();  ///< turns `up` to z
  Eigen::Vector3d p_centre = Eigen::Vector3d::Zero(),
                  q_centre = Eigen::Vector3d::Zero();  ///< metres, in the caller's coordinates

  LevelFrame(const Matches& matches, const Eigen::Vector3d& up);
  Pose pose(const LevelPose& found) const;
  LevelPose level_pose(const Pose& pose) const;
  /// The matches in the solver's coordinates, with their thresholds.
  LevelMatches levelled(const Matches& matches, const MatchRegistrationOptions& options) const;
};

}  // namespace scanlock
