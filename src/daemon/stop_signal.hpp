// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <chrono>

namespace scanlock {

/// A request to end, for threads that wait for descriptors or for time. It cannot be withdrawn.
class StopSignal {
 public:
  /// Throws std::runtime_error when the system has no free descriptor.
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  void request();
  bool requested() const { return requested_; }

  /// Waits for the request; true when it came within `duration`.
  bool wait_for(std::chrono::milliseconds duration) const;

  /// The event that wait_for_input() saw first.
  enum class Event { kStop, kInput, kTimeout };
  /// Waits until `fd` is readable, the request comes, or `duration` has passed. A negative `fd` is ignored.
  Event wait_for_input(int fd, std::chrono::milliseconds duration) const;

 private:
  int event_fd_;
  std::atomic<bool> requested_{false};
};

}  // namespace scanlock
