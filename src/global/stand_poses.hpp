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

/// Poses at which the source's sensor stands as high above the target's ground as above its own, in space
/// that is known to be free, or about where the target was seen from, with the headings at which most steep
/// surfaces of the two look the same way: guesses that need no descriptors, which look-alikes divide among
/// themselves and of which a cloud of few points has hardly any. `source`: its origin is where its sensor
/// stands, with normals; `target`: with normals and eyes, none without; `space`: that of the target; `voxel`:
/// metres, of both. `ups`: directions of the target's frame that may be the source's z axis; empty: z.
StandPoses stand_poses(const PointCloud& source, const PointCloud& target, const SeenSpace& space,
                       double voxel, const std::vector<Eigen::Vector3d>& ups);

}  // namespace scanlock
