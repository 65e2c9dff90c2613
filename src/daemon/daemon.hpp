// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>

#include "daemon/config.hpp"
#include "daemon/message_sink.hpp"
#include "daemon/pipeline.hpp"
#include "daemon/receiver.hpp"
#include "daemon/scan_slot.hpp"
#include "daemon/service_manager.hpp"
#include "daemon/statistics.hpp"
#include "daemon/stop_signal.hpp"

namespace scanlock {

/// Scans in, poses out: the pipeline (Intake, Pipeline, Outputs) over a network or a log. Live it has three
/// threads: one receives and keeps the freshest scan, one tracks, and the caller's own publishes everything;
/// each hands over through a place for one, so that nothing piles up. A log is replayed in the caller's
/// thread.
class Daemon {
 public:
  /// `version` goes into the status. Loads the configured map, and only then opens the log that is to be
  /// written. Throws std::runtime_error with a sentence for a configuration that cannot work, and for a map
  /// or a log that cannot be read or written.
  Daemon(const Config& config, const std::string& version);

  /// Runs until the stop signal, or to the end when the input is a log. On the stop signal the scan at hand
  /// is finished and published, and the map saved. Throws std::runtime_error with a sentence when the map or
  /// a log cannot be read or written, or where a log held no scan that could be used; then it has stopped
  /// all.
  void run(StopSignal& stop);

  Statistics::Report report() const { return statistics_.report(); }

 private:
  void replay(const StopSignal& stop);
  void serve(StopSignal& stop);
  void work();
  std::chrono::steady_clock::duration busy() const;
  void publish_until_the_end(const StopSignal& stop);

  const Config config_;
  const std::string version_;
  Statistics statistics_;
  Pipeline pipeline_;
  std::unique_ptr<MessageSink> sink_;
  WorkInbox inbox_;
  Slot<FinishedScan> finished_;
  ServiceManager manager_;
  /// When the worker took the item at hand; the epoch of the clock while it waits for one.
  std::atomic<std::chrono::steady_clock::time_point> busy_since_{std::chrono::steady_clock::time_point{}};
};

}  // namespace scanlock
