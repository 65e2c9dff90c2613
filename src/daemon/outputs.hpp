// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <string>

#include "daemon/config.hpp"
#include "daemon/log.hpp"
#include "daemon/statistics.hpp"
#include "messages/encode.hpp"

namespace scanlock {

/// A scan that the worker is done with, on its way out.
struct FinishedScan {
  TrackedScan tracked;  ///< already seen from the body
  std::int32_t scan_seq = 0;
  std::int64_t recv_utime = 0;  ///< microseconds, wall clock
  std::chrono::steady_clock::time_point arrival;
  StageTimes times;  ///< total_ms is filled in at the publishing
};

/// All publishing, for one thread.
class Outputs {
 public:
  /// Throws ConfigError when the output is a log and cannot be written. A network may come later.
  Outputs(const DaemonConfig& config, const std::string& version, Statistics& statistics);

  /// The pose in every form that the configuration names. A scan that was not tracked is counted and not
  /// published.
  void publish(const FinishedScan& finished);
  void publish_status();

  TrackingState state() const { return last_.state; }

 private:
  bool connect();
  void send(const std::string& channel, const Bytes& message);
  void publish_recovery(const Recovery& recovery, std::int64_t utime);
  void publish_poses(const TrackedScan& tracked, const OdometryContext& context);
  OdometryContext context_of(const FinishedScan& finished);

  const DaemonConfig& config_;
  const std::string version_, host_, url_;
  const bool replay_;  ///< the input is a log: nothing published depends on this machine's clock
  const TwistFrame twist_frame_;
  Statistics& statistics_;
  std::unique_ptr<lcm::LCM> lcm_;
  std::chrono::steady_clock::time_point next_attempt_{};
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::int64_t seq_ = 0, recovery_seq_ = 0;
  TrackedScan last_;  ///< its state and map figures go into the status
  Throttle failures_{std::chrono::seconds(10)};
};

}  // namespace scanlock
