// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "daemon/config.hpp"
#include "daemon/intake.hpp"
#include "daemon/outputs.hpp"
#include "daemon/pipeline.hpp"
#include "daemon/statistics.hpp"
#include "daemon/stop_signal.hpp"
#include "io/lcm_log.hpp"

namespace scanlock {

/// How an LCM log is played.
struct ReplayOptions {
  std::string log_path;
  double speed = 0;              ///< times as fast as it was recorded; 0: as fast as the machine goes
  std::int64_t first_utime = 0;  ///< microseconds: events before are left out
};
/// As LCM itself reads a file:// URL: in the time of the recording unless it says ?speed=0. Throws
/// ConfigError.
ReplayOptions replay_options(const std::string& url);

/// Told about every scan, used or not, and the milliseconds that it took from its message to its pose.
using ScanObserver = std::function<void(const FinishedScan&, double)>;

/// The pipeline over an LCM log: every scan, in order, in the caller's thread. What comes out depends on the
/// log and the configuration alone.
class Replay {
 public:
  /// Throws std::runtime_error with a sentence for a log that cannot be read. The references must outlive
  /// this object.
  Replay(const ReplayOptions& options, const Config& config, const std::string& version, Pipeline& pipeline,
         Statistics& statistics, MessageSink& sink);

  /// To the end of the log, or until the stop signal. `progress`: bytes done and in all; may be empty.
  void run(const StopSignal& stop, const ScanObserver& observer,
           const std::function<void(std::uint64_t, std::uint64_t)>& progress);

  /// A sentence on the state of the log; empty where it is whole.
  std::string damage() const;
  /// Why no scan could be used; empty where one was.
  std::string why_no_scan() const;

 private:
  bool wait_for(const LogEvent& event, const StopSignal& stop);
  void handle(std::vector<Intake::Item> items, const ScanObserver& observer);
  void note_other_channel(const LogEvent& event);

  const ReplayOptions options_;
  const Config& config_;
  Statistics& statistics_;
  LogReader reader_;
  Intake intake_;
  Pipeline& pipeline_;
  Outputs outputs_;
  std::int64_t begin_utime_ = 0;  ///< of the first event that was played, and when it was
  std::chrono::steady_clock::time_point begin_{};
  std::map<std::string, std::string>
      other_scans_;  ///< channels that nobody listens to, but carry scans; and types
};

}  // namespace scanlock
