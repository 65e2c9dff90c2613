// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "global/seen_space.hpp"

namespace scanlock {

/// Poses of a source in a target: each attitude at each place.
struct StandPoses {
  std::vector<Eigen::Matrix3d> attitudes;  ///< rotations, target from source
  std::vector<Eigen::Vector3d> places;     ///< of the source's origin in the target, metres
  std::size_t size() const { return attitudes.size() * places.size(); }
};

/// Hypotheses that need no descriptors, whose matches are divided among places that look alike, and too few
/// in a cloud of few points: the source's sensor is as high above the target's ground as above its own, in
/// free space or near a viewpoint of the target, with the headings at which most steep surfaces of the two
/// have like normals. `source`: its origin is where its sensor stands, with normals; `target`: with normals
/// and viewpoints (without them the result is empty); `space`: that of the target; `voxel`: metres, of both.
/// `ups`: directions of the target's frame that may be the source's z axis; empty: z.
StandPoses stand_poses(const PointCloud& source, const PointCloud& target, const SeenSpace& space,
                       double voxel, const std::vector<Eigen::Vector3d>& ups);

}  // namespace scanlock
