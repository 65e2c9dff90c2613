// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "odometry/recovery.hpp"

namespace scanlock {

/// Looks for the robot's place beside the tracking thread, which never waits for it. For one caller's thread.
/// One thread of its own for all searches: memory that one of them has used serves the next, where each new
/// thread would begin a heap of its own. The destructor waits for a search under way, which takes some tenths
/// of a second.
class BackgroundSearch {
 public:
  /// `at_once`: in the caller's thread, so that a replay does not depend on the speed of the machine.
  explicit BackgroundSearch(bool at_once) : at_once_(at_once) {}
  ~BackgroundSearch();
  BackgroundSearch(const BackgroundSearch&) = delete;
  BackgroundSearch& operator=(const BackgroundSearch&) = delete;

  /// Not while one is under way.
  void start(RecoveryRequest request);
  /// The answer, once. Throws what the search threw: out of memory, at most.
  std::optional<RecoveryAnswer> poll();

 private:
  void work();

  const bool at_once_;
  PlaceFinder finder_;  ///< the searching thread's own

  std::mutex mutex_;  ///< of the rest, but the thread
  std::condition_variable wake_;
  std::optional<RecoveryRequest> request_;
  std::optional<RecoveryAnswer> answer_;
  std::exception_ptr failure_;
  bool stop_ = false;
  std::thread thread_;  ///< from the first search on
};

}  // namespace scanlock
