// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "geometry/rigid.hpp"
#include "odometry/local_map.hpp"

namespace scanlock {

/// What a robot sees around it, and how it got to know: what a search for its place goes by.
struct Surroundings {
  const LocalMap& map;
  Pose map_from_body = Pose::Identity();
  double scene = 0;                   ///< metres, the mean reach of what sees it (see ArchivedKeyframe)
  int scans = 0;                      ///< that the map was made from
  std::optional<Eigen::Vector3d> up;  ///< as an attitude sensor measured it, axes of the map
};

}  // namespace scanlock
