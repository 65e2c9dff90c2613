// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// A map, and the way of a robot in it; everything in the frame of the map, metres, z up.
struct MapPicture {
  /// A pose that a relocalisation or a loop closure put right.
  struct Correction {
    Eigen::Vector3d position;
    double time_s = 0;     ///< since the first scan
    std::string evidence;  ///< in words
  };
  PointCloud map;
  std::vector<std::vector<Eigen::Vector3d>> ways;  ///< pieces without a jump, of poses that are known
  std::vector<Correction> corrections;
  std::string title;
};

/// An SVG picture from above: the vertical surfaces of the map as a floor plan, the ways, and the
/// corrections, numbered. Below, of the first ones, when and by what evidence.
std::string map_svg(const MapPicture& picture);

}  // namespace scanlock
