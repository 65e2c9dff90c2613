// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "odometry/tracker.hpp"

namespace scanlock {

/// The tracker follows the sensor; the robot wants its body. With the sensor rigidly at `body_from_sensor`,
/// returns the same result for the body: pose (the map is then where the body first stood), twist,
/// covariance, degenerate axes.
TrackedScan seen_from_body(TrackedScan tracked, const Pose& body_from_sensor);

}  // namespace scanlock
