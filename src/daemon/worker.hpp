// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "daemon/background_search.hpp"
#include "daemon/config.hpp"
#include "daemon/inbox.hpp"
#include "daemon/map_store.hpp"
#include "daemon/outputs.hpp"
#include "daemon/receiver.hpp"
#include "daemon/scan_slot.hpp"
#include "daemon/statistics.hpp"
#include "messages/reports.hpp"
#include "odometry/prior_judge.hpp"
#include "odometry/tracker.hpp"

namespace scanlock {

/// The working thread: tracks the scans, and does between two of them what is commanded.
class Worker {
 public:
  /// Loads the configured map. Throws std::runtime_error with a sentence when that is damaged.
  Worker(const Config& config, WorkInbox& inbox, Slot<FinishedScan>& finished, Statistics& statistics);

  /// The thread's body: until the inbox ends. Then the map is saved.
  void run();

 private:
  void work();
  void handle(const ReceivedScan& received);
  void handle(const Command& command);
  void execute(const Command& command);
  TrackedScan track_with_prior(const ReceivedScan& received);
  FinishedScan track(const ReceivedScan& received);

  const Pose body_from_sensor_;
  WorkInbox& inbox_;
  Slot<FinishedScan>& finished_;
  Statistics& statistics_;
  MapStore maps_;
  Tracker tracker_;
  PriorJudge judge_;
  BackgroundSearch search_;
};

}  // namespace scanlock
