// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "odometry/tracker.hpp"

namespace scanlock {

/// Converts the tracker's result, which is for the sensor, to the body, on which the sensor is mounted at
/// `body_from_sensor`: poses (the map frame becomes the first pose of the body), recovery, twist, covariance
/// and degenerate axes.
TrackedScan seen_from_body(TrackedScan tracked, const Pose& body_from_sensor);

}  // namespace scanlock
