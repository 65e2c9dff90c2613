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

/// Turns scans into poses: the pipeline (Intake, Pipeline, Outputs) on a network or a log. On a network it
/// uses three threads: one receives and keeps the newest scan, one tracks, and the caller's thread publishes.
/// Between two threads at most one scan waits, so that no backlog builds up. A log is replayed in the
/// caller's thread.
class Daemon {
 public:
  /// `version` is published in the status. Loads the configured map before it opens an output log. Throws
  /// std::runtime_error with a sentence for a configuration that cannot work, and for a map or a log that
  /// cannot be read or written.
  Daemon(const Config& config, const std::string& version);

  /// Runs until the stop signal, or to the end of the log when the input is one. On the stop signal the
  /// current scan is finished and published, and the map is saved. Throws std::runtime_error with a sentence
  /// when the map or a log cannot be read or written, or when no scan of a log could be used; all threads
  /// have ended then.
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
  /// When the worker took its current item; the epoch of the clock while it waits for an item.
  std::atomic<std::chrono::steady_clock::time_point> busy_since_{std::chrono::steady_clock::time_point{}};
};

}  // namespace scanlock
