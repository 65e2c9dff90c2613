// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "daemon/statistics.hpp"

namespace scanlock {

/// Detects that no usable scan arrives, and logs the probable cause: silence without a reason is the most
/// common complaint about a daemon on LCM. The interval between warnings doubles.
class SilenceWatch {
 public:
  SilenceWatch(std::string channels, double patience_s, std::chrono::steady_clock::time_point now);

  /// A line to log: a warning, or that scans arrive again.
  struct Line {
    bool warning;
    std::string text;
  };
  std::optional<Line> look(const Counters& counters, std::chrono::steady_clock::time_point now);

 private:
  std::string reason(const Counters& counters) const;

  std::string channels_;
  std::chrono::duration<double> patience_, next_warning_;
  std::chrono::steady_clock::time_point last_usable_;
  Counters then_;  ///< the counters at the last usable scan
  bool silent_ = false;
};

}  // namespace scanlock
