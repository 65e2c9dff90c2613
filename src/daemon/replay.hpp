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

/// Options for playing an LCM log.
struct ReplayOptions {
  std::string log_path;
  double speed = 0;              ///< multiple of the recorded speed; 0: as fast as the machine can
  std::int64_t first_utime = 0;  ///< microseconds: earlier events are skipped
};
/// As LCM itself reads a file:// URL: at the recorded speed unless the URL contains ?speed=. Throws
/// ConfigError.
ReplayOptions replay_options(const std::string& url);

/// Called for every scan, used or not, with the milliseconds from its message to its pose.
using ScanObserver = std::function<void(const FinishedScan&, double)>;

/// Runs the pipeline on an LCM log: every scan, in order, in the caller's thread. The result depends only on
/// the log and the configuration.
class Replay {
 public:
  /// Throws std::runtime_error with a sentence for a log that cannot be read. The references must outlive
  /// this object.
  Replay(const ReplayOptions& options, const Config& config, const std::string& version, Pipeline& pipeline,
         Statistics& statistics, MessageSink& sink);

  /// Runs to the end of the log, or until the stop signal. `progress`: bytes done, and bytes in total; may be
  /// empty.
  void run(const StopSignal& stop, const ScanObserver& observer,
           const std::function<void(std::uint64_t, std::uint64_t)>& progress);

  /// A sentence on the damage of the log; empty when it has none.
  std::string damage() const;
  /// The reason why no scan could be used; empty when one was used.
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
  std::int64_t begin_utime_ = 0;  ///< of the first event played, and (begin_) when it was played
  std::chrono::steady_clock::time_point begin_{};
  std::map<std::string, std::string>
      other_scans_;  ///< channels with scans that are not configured, and their types
};

}  // namespace scanlock
