// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>
#include <variant>

namespace scanlock {

/// The worker's queue, in the order of arrival: at most one scan, and a few commands. A new scan replaces a
/// waiting scan: LCM's own queue keeps the oldest and drops the newest, which delays poses. A scan never
/// displaces a command.
template <typename Scan, typename Command>
class Inbox {
 public:
  using Item = std::variant<Scan, Command>;

  explicit Inbox(std::size_t max_commands) : max_commands_(max_commands) {}

  /// Removes a waiting scan and appends `scan`; true when one was removed. After close(), drops `scan`.
  bool replace(Scan scan) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_) return false;
    const bool replaced = drop_scan();
    items_.emplace_back(std::move(scan));
    changed_.notify_all();
    return replaced;
  }

  /// Appends `scan` unless a scan is waiting; false when one is. After close(), drops `scan` and returns
  /// true.
  bool offer(Scan scan) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_) return true;
    if (scan_place() != items_.end()) return false;
    items_.emplace_back(std::move(scan));
    changed_.notify_all();
    return true;
  }

  /// Appends a command. False when too many commands wait, or the inbox is closed.
  bool post(Command command) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto waiting =
        static_cast<std::size_t>(std::count_if(items_.begin(), items_.end(), [](const Item& item) {
          return std::holds_alternative<Command>(item);
        }));
    if (closed_ || waiting >= max_commands_) return false;
    items_.emplace_back(std::move(command));
    changed_.notify_all();
    return true;
  }

  /// Waits for the next item; nothing once the inbox is closed or finished, and empty.
  std::optional<Item> take() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || finished_ || !items_.empty(); });
    if (items_.empty()) return std::nullopt;
    std::optional<Item> item = std::move(items_.front());
    items_.pop_front();
    changed_.notify_all();
    return item;
  }

  /// No more items will be added; waiting items can still be taken.
  void finish() {
    const std::lock_guard<std::mutex> lock(mutex_);
    finished_ = true;
    changed_.notify_all();
  }

  /// Ends the inbox: a waiting scan is dropped, waiting commands can still be taken.
  void close() {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
    drop_scan();
    changed_.notify_all();
  }

 private:
  auto scan_place() {
    return std::find_if(items_.begin(), items_.end(),
                        [](const Item& item) { return std::holds_alternative<Scan>(item); });
  }
  bool drop_scan() {
    const auto place = scan_place();
    if (place == items_.end()) return false;
    items_.erase(place);
    return true;
  }

  const std::size_t max_commands_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;
  bool finished_ = false, closed_ = false;
};

}  // namespace scanlock
