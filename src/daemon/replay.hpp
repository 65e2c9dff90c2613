// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "daemon/config.hpp"
#include "io/trajectory.hpp"

namespace scanlock {

struct ReplayOptions {
  std::string log_path;
  std::string output_log_path;  ///< pose_t and odometry_t of every scan; empty: not written
  std::string map_path;         ///< the map at the end, as a cloud file; empty: not written
};

struct ReplayResult {
  Trajectory trajectory;                 ///< of every scan that has a pose, predicted ones too
  std::int64_t scans = 0;                ///< messages on the scan channels that hold a scan
  std::int64_t rejected = 0;             ///< messages there that hold none
  std::string first_error;               ///< of the first of those
  std::int64_t bad_times = 0;            ///< scans with a repeated or an earlier utime
  std::array<std::int64_t, 6> states{};  ///< poses by TrackingState
  std::int64_t false_starts = 0;         ///< times the tracker began anew on a jump of the clock
  std::int64_t recoveries = 0;           ///< global registrations accepted
  std::int64_t recovery_failures = 0;    ///< and not accepted
  double distance_m = 0;                 ///< way along the trajectory
  std::vector<double> scan_ms;           ///< wall clock of decoding and tracking, each scan
  std::string damage;                    ///< a sentence on the state of the log, or empty
};

/// Runs the daemon's pipeline over an LCM log: every scan, in order, as fast as the machine goes. Everything
/// that is written depends on the log and the configuration alone. Throws std::runtime_error with a sentence
/// for a log that cannot be read or an output that cannot be written. `progress`: bytes done and in all.
ReplayResult replay_log(const ReplayOptions& options, const Config& config,
                        const std::function<void(std::uint64_t, std::uint64_t)>& progress);

}  // namespace scanlock
