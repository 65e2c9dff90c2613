// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "global/seen_space.hpp"

namespace scanlock {

/// Poses of a source in a target: every attitude at every place.
struct GroundPoses {
  std::vector<Eigen::Matrix3d> attitudes;  ///< rotations, target from source
  std::vector<Eigen::Vector3d> places;     ///< of the source's origin in the target, metres
  std::size_t size() const { return attitudes.size() * places.size(); }
};

/// Hypotheses without descriptors, whose matches are divided among places that look alike, and are too few in
/// a cloud of few points. The source's sensor is placed as high above the target's ground as above its own,
/// in free space, or near a viewpoint of the target, with the headings at which most steep surfaces of the
/// two clouds have similar normals. `source`: with normals, its origin is the sensor origin; `target`: with
/// normals and viewpoints; `space`: that of the target; `voxel`: metres, of both. `ups`: directions of the
/// target's frame that may be the source's z axis; empty: the z axis.
GroundPoses ground_poses(const PointCloud& source, const PointCloud& target, const SeenSpace& space,
                         double voxel, const std::vector<Eigen::Vector3d>& ups);

}  // namespace scanlock
