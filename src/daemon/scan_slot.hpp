// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

namespace scanlock {

/// A place for one thing between two threads. Live, the newest replaces what was not taken yet: LCM's own
/// queue keeps the oldest and drops the newest, which makes poses late. In a replay, nothing is lost: the
/// giver waits.
template <typename T>
class Slot {
 public:
  /// Puts `value`, replacing what is there; true when something was replaced. After `close` the value is
  /// dropped.
  bool replace(T value) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_) return false;
    const bool replaced = value_.has_value();
    value_ = std::move(value);
    changed_.notify_all();
    return replaced;
  }

  /// Waits until the place is free, then puts `value`; false when the slot was closed instead.
  bool put(T value) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !value_; });
    if (closed_) return false;
    value_ = std::move(value);
    changed_.notify_all();
    return true;
  }

  /// Waits for a value; nothing once the slot is closed, or finished and empty.
  std::optional<T> take() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || finished_ || value_; });
    return take_locked();
  }

  /// As `take`, but gives up at `deadline`: ask `ended` to tell the reasons apart.
  std::optional<T> take_until(std::chrono::steady_clock::time_point deadline) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_until(lock, deadline, [this] { return closed_ || finished_ || value_; });
    return take_locked();
  }

  /// Nothing is there and nothing will come.
  bool ended() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return closed_ || (finished_ && !value_);
  }

  /// No more will come: what is there can still be taken.
  void finish() {
    const std::lock_guard<std::mutex> lock(mutex_);
    finished_ = true;
    changed_.notify_all();
  }

  /// Ends it now: whoever waits is woken, what is there is dropped.
  void close() {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    value_.reset();
    changed_.notify_all();
  }

 private:
  std::optional<T> take_locked() {
    std::optional<T> taken = std::move(value_);
    value_.reset();
    changed_.notify_all();
    return taken;
  }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<T> value_;
  bool finished_ = false, closed_ = false;
};

}  // namespace scanlock
