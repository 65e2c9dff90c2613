// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "icp/cloud_alignment.hpp"

namespace scanlock {

/// Clouds one after the other, each registered to the one before it. The guess of a motion is the motion
/// before it or none, whichever puts the clouds closer together.
class CloudChain {
 public:
  /// `voxel`: metres to thin to, 0 for all points; nothing: chosen for each target by sensible_voxel().
  CloudChain(const CloudMethod& method, const CloudAlignmentOptions& options, std::optional<double> voxel);
  ~CloudChain();

  /// Adds a cloud; returns its alignment to the one before it, and nothing for the first. Throws
  /// std::invalid_argument, and changes nothing, when fewer than three points are finite.
  std::optional<CloudAlignment> add(const PointCloud& cloud);

  /// Of the clouds added so far, in the frame of the first.
  const std::vector<Pose>& poses() const { return poses_; }
  /// Metres that the last cloud was thinned to as a target; 0: not at all.
  double voxel() const { return target_voxel_; }

 private:
  CloudMethod method_;
  CloudAlignmentOptions options_;
  std::optional<double> voxel_;
  std::unique_ptr<CloudTarget> target_;
  double target_voxel_ = 0;
  Pose last_motion_ = Pose::Identity();
  std::vector<Pose> poses_;
};

}  // namespace scanlock
