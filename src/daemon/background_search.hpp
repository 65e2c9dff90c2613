// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <future>
#include <optional>

#include "odometry/recovery.hpp"

namespace scanlock {

/// Looks for the robot's place beside the tracking thread, which never waits for it. For one caller's thread.
/// The destructor waits for a search under way, which takes some tenths of a second.
class BackgroundSearch {
 public:
  /// `at_once`: in the caller's thread, so that a replay does not depend on the speed of the machine.
  explicit BackgroundSearch(bool at_once) : at_once_(at_once) {}

  /// Not while one is under way.
  void start(RecoveryRequest request);
  /// The answer, once.
  std::optional<RecoveryAnswer> poll();

 private:
  bool at_once_;
  PlaceFinder finder_;
  std::future<RecoveryAnswer> answer_;
};

}  // namespace scanlock
