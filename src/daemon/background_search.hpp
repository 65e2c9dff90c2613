// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "mapping/mapper.hpp"

namespace scanlock {

/// Searches for the robot's place and loop closures beside the tracking thread, which never waits for them.
/// For one caller's thread. One thread of its own for all searches: memory that one of them has used serves
/// the next, where each new thread would begin a heap of its own. The destructor waits for a search under
/// way, which takes some tenths of a second.
class BackgroundSearch {
 public:
  /// `at_once`: in the caller's thread, so that a replay does not depend on the speed of the machine.
  BackgroundSearch(const TrackerConfig& config, bool at_once) : at_once_(at_once), worker_(config) {}
  ~BackgroundSearch();
  BackgroundSearch(const BackgroundSearch&) = delete;
  BackgroundSearch& operator=(const BackgroundSearch&) = delete;

  /// Not while one is under way.
  void start(MapRequest request);
  /// The same, and waits for the answer, in the caller's thread.
  MapAnswer work(const MapRequest& request) { return worker_.work(request); }
  /// The answer, once. Throws what the search threw: out of memory, at most.
  std::optional<MapAnswer> poll();

 private:
  void run();

  const bool at_once_;
  MapWorker worker_;  ///< the searching thread's own

  std::mutex mutex_;  ///< of the rest, but the thread
  std::condition_variable wake_;
  std::optional<MapRequest> request_;
  std::optional<MapAnswer> answer_;
  std::exception_ptr failure_;
  bool stop_ = false;
  std::thread thread_;  ///< from the first search on
};

}  // namespace scanlock
