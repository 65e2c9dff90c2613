// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"

namespace scanlock {

/// Poses at which the source's sensor stands about where the target was seen from, with the headings at which
/// most steep surfaces of the two look the same way: guesses that need no descriptors, of which a cloud of
/// few points has hardly any. `source`: its origin is where its sensor stands, with normals; `target`: with
/// normals and eyes, none without; `voxel`: metres, of both. `ups`: directions of the target's frame that may
/// be the source's z axis; empty: z.
std::vector<Pose> stand_poses(const PointCloud& source, const PointCloud& target, double voxel,
                              const std::vector<Eigen::Vector3d>& ups);

}  // namespace scanlock
