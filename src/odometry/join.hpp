// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "odometry/excursion.hpp"
#include "odometry/keyframe_archive.hpp"

namespace scanlock {

/// Adds the keyframes that were seen while the robot was lost to the archive, where they show new ground.
/// Their poses follow from the pose that was found, `map_from_predicted`, and their covariances from the way
/// back from there. `reach`: metres, of the scan now.
void join(const Excursion& excursion, const Pose& map_from_predicted, double reach, KeyframeArchive* archive);

}  // namespace scanlock
