// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "daemon/config.hpp"
#include "daemon/outputs.hpp"
#include "daemon/receiver.hpp"
#include "daemon/scan_slot.hpp"
#include "daemon/statistics.hpp"
#include "daemon/stop_signal.hpp"

namespace scanlock {

/// Scans in, poses out. Three threads: one receives and keeps the freshest scan, one tracks, and the caller's
/// own publishes everything. Each hands over through a place for one, so that nothing piles up.
class Daemon {
 public:
  /// `version` goes into the status. Throws ConfigError for a configuration that cannot work.
  Daemon(const Config& config, const std::string& version);

  /// Runs until the stop signal, or to the end when the input is a log. On the stop signal the scan at hand
  /// is finished and published, and the map saved. Throws std::runtime_error with a sentence when the map or
  /// a log cannot be read.
  void run(const StopSignal& stop);

  Statistics::Report report() const { return statistics_.report(); }

 private:
  void publish_until_the_end(const StopSignal& stop);

  const Config config_;
  Statistics statistics_;
  Outputs outputs_;
  WorkInbox inbox_;
  Slot<FinishedScan> finished_;
};

}  // namespace scanlock
