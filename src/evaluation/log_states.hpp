// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "odometry/tracker.hpp"

namespace scanlock {

/// What the daemon said of one of its poses.
struct StampedState {
  double time_s = 0;  ///< seconds, stamp of the scan
  TrackingState state = TrackingState::kInitialising;
  std::uint32_t epoch = 0;
};

/// The channel on which scanlockd publishes what its poses are worth.
constexpr const char* kDefaultOdometryChannel = "SCANLOCK_ODOMETRY";

/// The states of scanlock.odometry_t on a channel, in the order of time. `source` is what load_trajectory
/// takes; empty for a source that is no log, or has none. Throws std::runtime_error when a log cannot be
/// read.
std::vector<StampedState> load_states(const std::string& source,
                                      const std::string& channel = kDefaultOdometryChannel);

}  // namespace scanlock
