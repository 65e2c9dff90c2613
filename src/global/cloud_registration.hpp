// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "global/cloud_check.hpp"
#include "global/cloud_description.hpp"
#include "global/match_registration.hpp"

namespace scanlock {

enum class GlobalVerdict {
  kCertain,     ///< the best consensus is proven, stands out, and the clouds confirm it
  kAmbiguous,   ///< another pose explains the clouds as well, or they leave a motion open
  kNoOverlap,   ///< no pose was found that the clouds confirm
  kUncertified  ///< a pose that the clouds confirm, but the search ended before its proof
};
/// certain, ambiguous, no overlap, uncertified.
const char* verdict_name(GlobalVerdict verdict);

struct CloudRegistrationOptions {
  double epsilon = 0;  ///< metres: the inlier threshold; 0: from the voxel
  double tilt = 0;     ///< radians: how well the clouds are levelled, see MatchRegistrationOptions
  /// Directions of the target's frame, any of which may be the source's z axis: the attitudes that a vehicle
  /// takes on the slopes of a place. Empty: the z axis. Then at least 8 matches have to agree for any
  /// consensus.
  std::vector<Eigen::Vector3d> target_ups;
  int lambda = 3;
  int attempts = 3;                 ///< match sets that are drawn at most
  std::size_t max_nodes = 200'000;  ///< of each search; ends it without a certificate
  double budget_s = std::numeric_limits<double>::infinity();  ///< wall seconds of each search
};

struct CloudRegistration {
  MatchRegistration solution;                  ///< of the match set that decided
  Pose start = Pose::Identity();               ///< least squares over the inliers of the solution
  Pose target_from_source = Pose::Identity();  ///< refined with the clouds; always finite
  GlobalVerdict verdict = GlobalVerdict::kNoOverlap;
  std::string why;  ///< a sentence for people
  CloudFit fit, runner_up_fit;
  bool same_peak = false;             ///< refined, the runner-up is the best pose: it was its flank
  std::uint32_t degenerate_axes = 0;  ///< of the refinement
  double epsilon = 0;                 ///< metres, as used
  int attempts = 0;
  double features_ms = 0, matching_ms = 0, refinement_ms = 0;  ///< CPU, of all attempts
};

/// Registers two described levelled clouds without an initial guess: matches, the largest consensus, a short
/// refinement with the clouds, and what the clouds say about it. When they do not confirm it, matches are
/// drawn again, from more keypoints and from a wider look. Descriptions have the same voxel and options, and
/// throw std::invalid_argument when not. Deterministic, unless budget_s ends a search.
CloudRegistration register_clouds(const CloudDescription& source, const CloudDescription& target,
                                  const CloudRegistrationOptions& options = {});

}  // namespace scanlock
