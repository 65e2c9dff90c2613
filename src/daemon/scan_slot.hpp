// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

namespace scanlock {

/// Passes values between two threads, one at a time. replace() overwrites a value that was not taken yet, so
/// that the reader gets the newest; put() waits until it has been taken, so that none is lost.
template <typename T>
class Slot {
 public:
  /// Stores `value`, replacing a value that was not taken; true when one was replaced. After close(), drops
  /// `value`.
  bool replace(T value) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_) return false;
    const bool replaced = value_.has_value();
    value_ = std::move(value);
    changed_.notify_all();
    return replaced;
  }

  /// Waits until the slot is empty, then stores `value`; false when the slot was closed.
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

  /// As take(), but returns nothing at `deadline`; ended() then distinguishes the reasons.
  std::optional<T> take_until(std::chrono::steady_clock::time_point deadline) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_until(lock, deadline, [this] { return closed_ || finished_ || value_; });
    return take_locked();
  }

  /// True when the slot is empty and no value will follow.
  bool ended() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return closed_ || (finished_ && !value_);
  }

  /// No more values will follow; a stored value can still be taken.
  void finish() {
    const std::lock_guard<std::mutex> lock(mutex_);
    finished_ = true;
    changed_.notify_all();
  }

  /// Ends the slot: waiting threads are woken, a stored value is dropped.
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
