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
/// there, either way round, and how near their descriptors are, see MutualPair.
struct SurfaceMatch {
  Eigen::Vector3d p, q, normal_p, normal_q;
  int rank = 1;
};

/// The pose near `pose` at which the surfaces of the matches meet, reached by turns about the target's axis
/// pose.linear().col(2), near `centre` of the source (metres), and shifts. Along a wall all descriptors are
/// alike, so matches are uncertain within a surface and precise along its normal: residuals in the two
/// directions are weighted by the spread of each. Matches farther off than two `epsilon` (metres) along the
/// normal, or four within the surface, do not count; nor does anything when fewer than eight are near.
Pose fit_surfaces(const std::vector<SurfaceMatch>& matches, Pose pose, const Eigen::Vector3d& centre,
                  double epsilon);

}  // namespace scanlock
