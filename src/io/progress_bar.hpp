// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

namespace scanlock {

/// A bar on standard error, once the work has taken longer than two seconds; nothing when that is no
/// terminal.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label);
  /// Wipes the bar off the line.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::uint64_t done, std::uint64_t total);
  /// update() as a value, which the bar has to outlive.
  std::function<void(std::uint64_t, std::uint64_t)> updater() {
    return [this](std::uint64_t done, std::uint64_t total) { update(done, total); };
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  bool terminal_;
  bool drawn_ = false;
  Clock::time_point next_;
};

}  // namespace scanlock
