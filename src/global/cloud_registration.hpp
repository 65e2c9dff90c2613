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
  kCertain,     ///< the best consensus is proven, stands out, and the clouds confirm it
  kAmbiguous,   ///< another pose explains the clouds as well, or they do not constrain a direction
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
  /// True: the fit of the clouds decides between the hypotheses of the matches. False: the caller decides;
  /// the clouds only sort the hypotheses, the likeliest first, and drop those that they contradict. The
  /// verdict is then never certain: `log_odds` tells. Where no pose has enough matches, as of sparse clouds,
  /// many more are drawn.
  bool judged = true;
  /// Further hypotheses to compare, unless judged: see CloudRegistration::standing.
  std::vector<Pose> proposals;
  int lambda = 3;
  int attempts = 2;                 ///< match sets that are drawn at most, see register_clouds()
  std::size_t max_nodes = 200'000;  ///< of each search, which ends there without a certificate
  std::size_t max_work =
      std::numeric_limits<std::size_t>::max();  ///< of all searches, see MatchRegistrationOptions
  double budget_s = std::numeric_limits<double>::infinity();  ///< wall seconds of each search
};

struct CloudRegistration {
  MatchRegistration solution;  ///< of the match set that decided
  /// The pose of the largest consensus, level. When judged: the fit to the surfaces of the matches
  /// near the refined pose.
  Pose start = Pose::Identity();
  Pose target_from_source = Pose::Identity();  ///< refined with the clouds; always finite
  GlobalVerdict verdict = GlobalVerdict::kNoOverlap;
  std::string why;                    ///< a sentence for people
  CloudFit fit, rival_fit;            ///< of target_from_source, and of the best of `rivals`
  std::vector<Pose> rivals;           ///< all other poses that were compared, refined
  double log_odds = 0;                ///< see hypothesis.hpp; of target_from_source, unless judged
  std::vector<Hypothesis> standing;   ///< the proposals that the clouds do not contradict
  std::uint32_t degenerate_axes = 0;  ///< of the refinement
  double epsilon = 0;                 ///< metres, as used
  int attempts = 0;
  double matching_ms = 0, refinement_ms = 0, pruning_ms = 0, search_ms = 0;  ///< CPU, of all attempts
  std::size_t nodes = 0;                                                     ///< of all attempts
};

/// Registers two described levelled clouds without an initial guess: matches, the largest consensus, a short
/// refinement with the clouds, and the fit of the clouds there. When the fit does not confirm it, matches are
/// drawn again from more keypoints, and a third time with wider descriptors (which costs time, and seldom
/// helps). Descriptions have the same voxel and options, and throw std::invalid_argument when not.
/// Deterministic, unless budget_s ends a search. `target_check`: of the target's points, where there is one
/// already; it has to outlive the call.
CloudRegistration register_clouds(const CloudDescription& source, const CloudDescription& target,
                                  const CloudRegistrationOptions& options = {},
                                  const CloudCheck* target_check = nullptr);

/// describe() of a cloud as it comes, in a frame whose origin is where its sensor stood, levelled by the
/// direction `up` in it (any length but 0; else throws std::invalid_argument).
CloudDescription describe_levelled(const PointCloud& cloud, const Eigen::Vector3d& up,
                                   const DescriptionOptions& options);
/// register_clouds() of two such; the poses are between the clouds' own frames.
CloudRegistration register_levelled(const CloudDescription& source, const CloudDescription& target,
                                    const Eigen::Vector3d& up, const CloudRegistrationOptions& options = {});

/// Both at once. `description.voxel` 0: from the target.
CloudRegistration register_raw_clouds(const PointCloud& source, const PointCloud& target,
                                      const Eigen::Vector3d& up, const DescriptionOptions& description = {},
                                      const CloudRegistrationOptions& options = {});

}  // namespace scanlock
