// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "daemon/config.hpp"
#include "daemon/message_sink.hpp"
#include "daemon/pipeline.hpp"
#include "daemon/statistics.hpp"
#include "messages/encode.hpp"

namespace scanlock {

/// The last stage of the pipeline: converts finished scans to messages. In a replay, no message depends on
/// this machine, and the status period is measured by the stamps of the scans. To be used by one thread.
class Outputs {
 public:
  Outputs(const DaemonConfig& config, const std::string& version, Statistics& statistics, MessageSink& sink,
          Pipeline::Mode mode);

  /// Publishes the pose as every type that the configuration names. A scan that was not used is counted but
  /// not published, except an empty scan, whose pose is predicted.
  void publish(const FinishedScan& finished);
  /// Publishes the status with the current time; in a replay, with the time of the last scan.
  void publish_status();

  TrackingState state() const { return last_.state; }

 private:
  bool replay() const { return mode_ == Pipeline::Mode::kReplay; }
  void send(const std::string& channel, const Bytes& message);
  void publish_recovery(const Recovery& recovery, std::int64_t utime);
  void publish_poses(const TrackedScan& tracked, const OdometryContext& context);
  OdometryContext context_of(const FinishedScan& finished);
  void say_state(const TrackedScan& tracked) const;
  bool status_is_due(std::int64_t utime) const;

  const DaemonConfig& config_;
  const std::string version_, host_;
  const TwistFrame twist_frame_;
  const Pipeline::Mode mode_;
  Statistics& statistics_;
  MessageSink& sink_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::int64_t seq_ = 0, recovery_seq_ = 0;
  std::int64_t utime_ = 0;                           ///< of the log events being written
  TrackedScan last_;                                 ///< source of the state and map figures of the status
  std::int64_t first_utime_ = 0, status_utime_ = 0;  ///< in a replay
};

}  // namespace scanlock
