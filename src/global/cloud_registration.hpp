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
#include "global/hypothesis.hpp"
#include "global/max_consensus.hpp"

namespace scanlock {

enum class GlobalVerdict {
  kCertain,     ///< the best consensus is proven and stands out, and the clouds confirm its pose
  kAmbiguous,   ///< another pose fits the clouds about as well, none stands out, or a direction is open
  kNoOverlap,   ///< no pose was found that the clouds confirm
  kUncertified  ///< a pose that the clouds confirm, but the search ended before its proof
};
/// certain, ambiguous, no overlap, uncertified.
const char* verdict_name(GlobalVerdict verdict);

struct CloudRegistrationOptions {
  double epsilon = 0;  ///< metres: the inlier threshold; 0: 0.75 voxels
  double tilt = 0;     ///< radians: error of the levelling of the clouds, see MatchRegistrationOptions
  /// Directions of the target's frame, any of which may be the source's z axis: the attitudes that a vehicle
  /// takes on the slopes of a place. Empty: the z axis. With directions, no consensus below 8 matches counts.
  std::vector<Eigen::Vector3d> target_ups;
  /// True: the fit of the clouds decides between the hypotheses from the matches. False: the caller decides;
  /// the clouds only sort the hypotheses, the best score first, and drop those that they contradict. The
  /// verdict is then never certain, and `log_odds` measures the certainty. Where no pose has enough matches,
  /// as in sparse clouds, a larger match set is used.
  bool judged = true;
  /// Further hypotheses to compare, unless judged: see CloudRegistration::standing.
  std::vector<Pose> proposals;
  int lambda = 3;                   ///< see match()
  int attempts = 2;                 ///< largest number of match sets, see register_clouds()
  std::size_t max_nodes = 200'000;  ///< of each search, which ends there without a certificate
  std::size_t max_work =
      std::numeric_limits<std::size_t>::max();  ///< of all searches, see MatchRegistrationOptions
  double budget_s = std::numeric_limits<double>::infinity();  ///< wall-clock seconds of each search
};

struct CloudRegistration {
  MatchRegistration solution;  ///< of the match set that decided
  /// The best hypothesis before its refinement with the clouds, level: the fit to its matches. When judged:
  /// the fit to the surfaces of the matches near the refined pose.
  Pose start = Pose::Identity();
  Pose target_from_source = Pose::Identity();  ///< refined with the clouds; always finite
  GlobalVerdict verdict = GlobalVerdict::kNoOverlap;
  std::string why;                         ///< the reason of the verdict, a sentence for users
  CloudFit fit, runner_up_fit;             ///< of target_from_source, and of the best of `runners_up`
  std::vector<Pose> runners_up;            ///< refined poses of the other hypotheses
  double log_odds = 0;                     ///< see hypothesis.hpp; of target_from_source, unless judged
  std::vector<Hypothesis> uncontradicted;  ///< the proposals that the clouds do not contradict
  std::uint32_t degenerate_axes = 0;       ///< of the refinement
  double epsilon = 0;                      ///< metres: the inlier threshold that was used
  int attempts = 0;
  double matching_ms = 0, refinement_ms = 0, pruning_ms = 0, search_ms = 0;  ///< CPU time of all attempts
  std::size_t nodes = 0;                                                     ///< of all attempts
};

/// Registers two described levelled clouds without an initial guess: matches, the largest consensus, a short
/// refinement with the clouds, and the fit of the clouds there. Unless the verdict is certain, a second
/// attempt uses the matches of more keypoints, and a third one wider descriptors (which costs time, and
/// seldom helps). Both descriptions must have the same options, and the same voxel: throws
/// std::invalid_argument otherwise. Deterministic, unless budget_s ends a search. `target_check`: that of the
/// target's points if the caller has one; it has to outlive the call.
CloudRegistration register_clouds(const CloudDescription& source, const CloudDescription& target,
                                  const CloudRegistrationOptions& options = {},
                                  const CloudCheck* target_check = nullptr);

/// describe() of a cloud in the frame of its sensor, after levelling by the direction `up` of that frame (any
/// length but 0; else throws std::invalid_argument).
CloudDescription describe_levelled(const PointCloud& cloud, const Eigen::Vector3d& up,
                                   const DescriptionOptions& options);
/// register_clouds() of two results of describe_levelled(); the poses are between the clouds' own frames.
CloudRegistration register_levelled(const CloudDescription& source, const CloudDescription& target,
                                    const Eigen::Vector3d& up, const CloudRegistrationOptions& options = {});

/// describe_levelled() of both clouds and register_levelled(). `description.voxel` 0: that of the target.
CloudRegistration register_raw_clouds(const PointCloud& source, const PointCloud& target,
                                      const Eigen::Vector3d& up, const DescriptionOptions& description = {},
                                      const CloudRegistrationOptions& options = {});

}  // namespace scanlock
