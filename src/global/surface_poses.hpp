// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "geometry/rigid.hpp"
#include "global/cloud_check.hpp"
#include "global/ground_poses.hpp"
#include "global/surface_fit.hpp"

namespace scanlock {

/// Hypotheses by the fit of the clouds, independent of their consensus: among corridors that look alike, the
/// right matches are too few to stand out. Every match of two steep surfaces defines a pose (heading by the
/// normals, position by the points), whose coarse score is that of coarse_fit(). Returns the `count` poses of
/// best score, the best first, each a different hypothesis from those before it (see separation()); they are
/// coarse, and have to be refined. `guesses`: further poses to score. `ups`: directions of the target's frame
/// that may be the source's z axis; empty: the z axis. `centre`, of the source, and `epsilon`: metres.
std::vector<Pose> surface_poses(const std::vector<SurfaceMatch>& matches, const GroundPoses& guesses,
                                const CloudCheck& source, const CloudCheck& target,
                                const std::vector<Eigen::Vector3d>& ups, const Eigen::Vector3d& centre,
                                double epsilon, std::size_t count);

}  // namespace scanlock
