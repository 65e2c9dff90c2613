// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/rigid.hpp"
#include "odometry/keyframe_archive.hpp"
#include "odometry/odometer.hpp"

namespace scanlock {

/// Keeps the local map founded on the fixed keyframes of an archive, those of a given map, as the robot
/// moves.
class GivenGround {
 public:
  /// Where fixed keyframes show the ground around the robot, the map of the odometer is founded on them, anew
  /// as it moves on, and its drift is zero. `voxel` in metres. Throws PointsUnreadable, and changes nothing
  /// of the odometer then.
  void follow(const KeyframeArchive& archive, double voxel, Odometer* odometer);
  /// The archive or the map of the odometer has changed.
  void forget() { within_ = 0; }

 private:
  Eigen::Vector3d at_ = Eigen::Vector3d::Zero();  ///< where the map was last founded
  double within_ = 0;                             ///< metres from there in which that is near enough
};

}  // namespace scanlock
