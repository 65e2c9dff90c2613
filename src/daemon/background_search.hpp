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

/// Searches for the robot's pose and for loop closures in parallel with the tracking thread, which never
/// waits for them. To be used by one thread. All searches run in one thread, so that each reuses the heap
/// memory of the one before it; a new thread per search would start a heap of its own. The destructor waits
/// for a running search, which takes some tenths of a second.
class BackgroundSearch {
 public:
  /// `at_once`: search in the caller's thread, so that a replay does not depend on the speed of the machine.
  BackgroundSearch(const TrackerConfig& config, bool at_once) : at_once_(at_once), worker_(config) {}
  ~BackgroundSearch();
  BackgroundSearch(const BackgroundSearch&) = delete;
  BackgroundSearch& operator=(const BackgroundSearch&) = delete;

  /// Starts a search; not to be called while one is running.
  void start(MapRequest request);
  /// Searches in the caller's thread and returns the answer.
  MapAnswer work(const MapRequest& request) { return worker_.work(request); }
  /// The answer of the finished search, once. Throws the exception that the search threw (only lack of
  /// memory).
  std::optional<MapAnswer> poll();

 private:
  void run();

  const bool at_once_;
  MapWorker worker_;  ///< used by the searching thread only

  std::mutex mutex_;  ///< guards the members below, except thread_
  std::condition_variable wake_;
  std::optional<MapRequest> request_;
  std::optional<MapAnswer> answer_;
  std::exception_ptr failure_;
  bool stop_ = false;
  std::thread thread_;  ///< started by the first search
};

}  // namespace scanlock
