// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <chrono>

namespace scanlock {

/// "Please end now", for threads that wait on descriptors or on time. Once requested, it stays so.
class StopSignal {
 public:
  /// Throws std::runtime_error when the system gives no descriptor.
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  void request();
  bool requested() const { return requested_; }

  /// Waits for the request; true when it came within `duration`.
  bool wait_for(std::chrono::milliseconds duration) const;

  /// What `wait_for_input` saw first.
  enum class Event { kStop, kInput, kTimeout };
  /// Waits until `fd` can be read, the request comes or `duration` has passed. A negative `fd` is not waited
  /// for.
  Event wait_for_input(int fd, std::chrono::milliseconds duration) const;

 private:
  int event_fd_;
  std::atomic<bool> requested_{false};
};

}  // namespace scanlock
