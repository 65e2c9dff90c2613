// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "geometry/rigid.hpp"
#include "odometry/local_map.hpp"

namespace scanlock {

/// The input of a search for the robot's pose: the map made from recent scans, and the robot's pose in it.
struct Surroundings {
  const LocalMap& map;
  Pose map_from_body = Pose::Identity();
  double scene = 0;  ///< metres, the mean reach of the keyframes there (see ArchivedKeyframe)
  int scans = 0;     ///< from which the map was made
  std::optional<Eigen::Vector3d> up;  ///< upward direction by an attitude sensor, axes of the map
};

}  // namespace scanlock
