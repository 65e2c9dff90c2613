// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "odometry/excursion.hpp"
#include "odometry/keyframe_archive.hpp"

namespace scanlock {

/// What was seen while the robot was lost becomes part of the map, where it shows new ground. It lies to the
/// map as the pose does that was found, and as well as the way from there is known. `reach`: metres, of the
/// scan now.
void join(const Excursion& excursion, const Pose& map_from_predicted, double reach, KeyframeArchive* archive);

}  // namespace scanlock
