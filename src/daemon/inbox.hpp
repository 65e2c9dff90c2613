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

/// What waits for the worker, in the order of arrival: one scan at most, and a few commands. A fresh scan
/// replaces one that was not taken yet: LCM's own queue keeps the oldest and drops the newest, which makes
/// poses late. A command is never lost to a scan.
template <typename Scan, typename Command>
class Inbox {
 public:
  using Item = std::variant<Scan, Command>;

  explicit Inbox(std::size_t max_commands) : max_commands_(max_commands) {}

  /// Puts `scan` at the end, in place of one that waits; true when there was one. Dropped after `close`.
  bool replace(Scan scan) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_) return false;
    const bool replaced = drop_scan();
    items_.emplace_back(std::move(scan));
    changed_.notify_all();
    return replaced;
  }

  /// Puts `scan` at the end where no scan waits; false where one does. Dropped after `close`.
  bool offer(Scan scan) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (closed_) return true;
    if (scan_place() != items_.end()) return false;
    items_.emplace_back(std::move(scan));
    changed_.notify_all();
    return true;
  }

  /// False when too many commands wait, or the inbox is closed.
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

  /// No more will come: what is there can still be taken.
  void finish() {
    const std::lock_guard<std::mutex> lock(mutex_);
    finished_ = true;
    changed_.notify_all();
  }

  /// Ends it now: a scan that waits is dropped, commands that were accepted can still be taken.
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
