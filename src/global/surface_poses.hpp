// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "geometry/rigid.hpp"
#include "global/cloud_check.hpp"
#include "global/stand_poses.hpp"
#include "global/surface_fit.hpp"

namespace scanlock {

/// What the clouds themselves hold for likely, however few matches agree on it: in a building full of
/// corridors the right matches are too few to stand out. Every match of two steep surfaces that look the same
/// way is a pose (heading by the normals, position by the points); a glance at a part of the clouds tells
/// what each is worth. The `count` best, the best first, none like another (see separation()); poses at a
/// glance, to be refined. `guesses`: poses to be looked at as well. `ups`: directions of the target's frame
/// that may be the source's z axis; empty: z. `centre`, of the source, and `epsilon`: metres.
std::vector<Pose> surface_poses(const std::vector<SurfaceMatch>& matches, const StandPoses& guesses,
                                const CloudCheck& source, const CloudCheck& target,
                                const std::vector<Eigen::Vector3d>& ups, const Eigen::Vector3d& centre,
                                double epsilon, std::size_t count);

}  // namespace scanlock
