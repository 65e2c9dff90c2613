// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "daemon/statistics.hpp"

namespace scanlock {

/// Notices that no usable scan comes, and says why that may be: the most common complaint about a daemon on
/// LCM is that it stays silent. The warning is repeated at doubling intervals.
class SilenceWatch {
 public:
  SilenceWatch(std::string channels, double patience_s, std::chrono::steady_clock::time_point now);

  /// A line to log, if there is one to say now: a warning, or that the scans are back.
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
  Counters then_;  ///< as they stood at the last usable scan
  bool silent_ = false;
};

}  // namespace scanlock
