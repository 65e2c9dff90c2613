// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "odometry/keyframe_archive.hpp"
#include "odometry/lost_mode_odometry.hpp"

namespace scanlock {

/// Adds the keyframes of lost-mode odometry to the archive, except where the archive has a keyframe within a
/// third of `reach`. Their poses follow from `map_from_predicted`, the correction that relocalisation found,
/// and their covariances from the covariance of lost-mode odometry, transformed to the keyframe. `reach`:
/// metres, median range of the current scan.
void join(const LostModeOdometry& lost_odometry, const Pose& map_from_predicted, double reach,
          KeyframeArchive* archive);

}  // namespace scanlock
