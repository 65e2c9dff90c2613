// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/rigid.hpp"

namespace scanlock {

/// Least cosine between the unit normals of two points that may lie on one surface.
inline constexpr double kSameWay = 0.7;

/// A candidate correspondence between surfaces: source point p and target point q, metres, the unit normals
/// there, of arbitrary sign, and the rank of the pair, see MutualPair.
struct SurfaceMatch {
  Eigen::Vector3d p, q, normal_p, normal_q;
  int rank = 1;
};

/// The pose near `pose` at which the surfaces of the matches meet, reached by translations and by rotations
/// about the target's axis pose.linear().col(2) through `centre` of the source (metres). Descriptors are
/// similar all along a wall, so that matches are uncertain within a surface and precise along its normal:
/// residuals in the two directions are weighted by the spread of each. Matches with a distance of more than
/// two scales along the normal (the scale falls from `epsilon`, metres, to 0.35 `epsilon`), or four `epsilon`
/// within the surface, do not count. With fewer than eight near matches the pose stays.
Pose fit_surfaces(const std::vector<SurfaceMatch>& matches, Pose pose, const Eigen::Vector3d& centre,
                  double epsilon);

}  // namespace scanlock
