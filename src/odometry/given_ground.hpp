// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/rigid.hpp"
#include "odometry/keyframe_archive.hpp"
#include "odometry/odometer.hpp"

namespace scanlock {

/// Loads the fixed keyframes of an archive, those of a given map, into the local map as the robot moves.
class GivenGround {
 public:
  /// Where the robot is within reach of a fixed keyframe, loads the fixed keyframes around it into the map of
  /// the odometer (see LocalMap::found_on()) and sets its drift to zero; again when the robot has moved by a
  /// third of the size of the scene. `voxel` in metres. Throws PointsUnreadable, and then leaves the odometer
  /// unchanged.
  void follow(const KeyframeArchive& archive, double voxel, Odometer* odometer);
  /// To be called when the archive or the map of the odometer was changed: the next follow() loads anew.
  void forget() { within_ = 0; }

 private:
  Eigen::Vector3d at_ = Eigen::Vector3d::Zero();  ///< position (map frame) of the last load
  double within_ = 0;                             ///< metres from at_ within which nothing is loaded
};

}  // namespace scanlock
