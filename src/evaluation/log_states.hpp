// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "odometry/tracker.hpp"

namespace scanlock {

/// The state that the daemon published with one of its poses.
struct StampedState {
  double time_s = 0;  ///< seconds, stamp of the scan
  TrackingState state = TrackingState::kInitialising;
  std::uint32_t epoch = 0;
  std::uint32_t degenerate_axes = 0;  ///< bits 0..2: translation along body x y z, 3..5: rotation about them
  Pose map_from_body = Pose::Identity();
  Matrix6 covariance = Matrix6::Zero();  ///< of T exp(xi), [translation; rotation] in the body frame
};

/// The channel on which scanlockd publishes state and covariance of its poses.
constexpr const char* kDefaultOdometryChannel = "SCANLOCK_ODOMETRY";

/// The states of scanlock.odometry_t on a channel, in the order of time. `source` is as for
/// load_trajectory(); the result is empty when it is not a log, or has no such messages. Throws
/// std::runtime_error when a log cannot be read.
std::vector<StampedState> load_states(const std::string& source,
                                      const std::string& channel = kDefaultOdometryChannel);

constexpr double kSameTime = 2e-6;  ///< seconds; doubles near 1.6e9 have a resolution of 0.2 us

/// The state at a time; null when none is within kSameTime. `states` must be in the order of time.
const StampedState* said_at(const std::vector<StampedState>& states, double time_s);

}  // namespace scanlock
