// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// A map and the path of a robot in it; all coordinates are in the map frame, metres, z up.
struct MapPicture {
  /// A pose corrected by a relocalisation or a loop closure.
  struct Correction {
    Eigen::Vector3d position;
    double time_s = 0;     ///< seconds since the first scan
    std::string evidence;  ///< in words
  };
  PointCloud map;
  std::vector<std::vector<Eigen::Vector3d>> ways;  ///< path segments of known poses, without jumps
  std::vector<Correction> corrections;
  std::string title;
};

/// An SVG picture from above: the vertical surfaces of the map as a floor plan, the path, and the numbered
/// corrections. Below it, time and evidence of the first corrections.
std::string map_svg(const MapPicture& picture);

}  // namespace scanlock
