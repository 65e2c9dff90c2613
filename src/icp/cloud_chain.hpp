// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "icp/cloud_alignment.hpp"

namespace scanlock {

/// Where somebody who knows more has a cloud of a chain, in the frame of the one before it.
struct ChainGuess {
  Pose target_from_source = Pose::Identity();
  double nu_max = 0;    ///< metres, how well it is known; 0: CloudAlignmentOptions::nu_max
  bool refined = true;  ///< false: the guess is the link, whatever the clouds say
};

/// Clouds one after the other, each registered to the one before it. Without a guess that of a motion is the
/// motion before it or none, whichever puts the clouds closer together.
class CloudChain {
 public:
  /// `voxel`: metres to thin to, 0 for all points; nothing: chosen for each target by sensible_voxel().
  /// `options.start_may_be_better` speaks of guesses that are given.
  CloudChain(const CloudMethod& method, const CloudAlignmentOptions& options, std::optional<double> voxel);
  ~CloudChain();

  /// Adds a cloud; returns its alignment to the one before it, and nothing for the first. Throws
  /// std::invalid_argument, and changes nothing, when fewer than three points are finite.
  std::optional<CloudAlignment> add(const PointCloud& cloud, const std::optional<ChainGuess>& guess = {});

  /// Of the clouds added so far, in the frame of the first.
  const std::vector<Pose>& poses() const { return poses_; }
  /// Metres that the last cloud was thinned to as a target; 0: not at all.
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
