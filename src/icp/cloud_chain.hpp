// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "icp/cloud_alignment.hpp"

namespace scanlock {

/// A pose that the caller knows for a cloud of a chain, in the frame of the previous cloud.
struct ChainGuess {
  Pose target_from_source = Pose::Identity();
  double nu_max = 0;    ///< metres: uncertainty of the guess; 0: CloudAlignmentOptions::nu_max
  bool refined = true;  ///< false: the guess is taken as the result, without an alignment
};

/// A sequence of clouds, each registered to the previous one. Without a given guess, the start is the motion
/// between the previous two clouds or no motion, whichever has the smaller misfit().
class CloudChain {
 public:
  /// `voxel`: metres by which clouds are thinned, 0 for all points; nullopt: sensible_voxel() of each target.
  /// `options.start_may_be_better` applies only to guesses that are given to add().
  CloudChain(const CloudMethod& method, const CloudAlignmentOptions& options, std::optional<double> voxel);
  ~CloudChain();

  /// Adds a cloud; returns its alignment to the previous cloud, nullopt for the first one. Throws
  /// std::invalid_argument, and changes nothing, when fewer than three points are finite.
  std::optional<CloudAlignment> add(const PointCloud& cloud, const std::optional<ChainGuess>& guess = {});

  /// Poses of the clouds added so far, in the frame of the first.
  const std::vector<Pose>& poses() const { return poses_; }
  /// The voxel, metres, that the last cloud was thinned by as a target; 0: not thinned.
  double voxel() const { return target_voxel_; }

 private:
  Pose likely_motion(const PointCloud& source) const;

  CloudMethod method_;
  CloudAlignmentOptions options_;
  std::optional<double> voxel_;
  std::unique_ptr<CloudTarget> target_;
  double target_voxel_ = 0;
  Pose last_motion_ = Pose::Identity();
  std::vector<Pose> poses_;
};

}  // namespace scanlock
