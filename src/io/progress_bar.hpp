// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

namespace scanlock {

/// A progress bar on standard error, shown once the work has taken longer than two seconds, and only on a
/// terminal.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label);
  /// Erases the bar.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::uint64_t done, std::uint64_t total);
  /// update() as a function object; the bar must outlive it.
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
