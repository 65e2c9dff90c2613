// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace scanlock {

/// The numbers are syslog's priorities, which journald reads at the start of a line.
enum class LogLevel { kError = 3, kWarning = 4, kInfo = 6 };

/// Prints one line on standard error, in one write; control characters are replaced.
void log_line(LogLevel level, const std::string& text);

/// Receives the log lines of a part of the daemon: log_line(), or a function that discards them.
using LogFunction = std::function<void(LogLevel, const std::string&)>;

/// Passes one event per period and counts the others.
class Throttle {
 public:
  explicit Throttle(std::chrono::milliseconds period) : period_(period) {}

  /// True when the event at `now` is to be reported; suppressed() is then the number of events suppressed
  /// before it.
  bool allows(std::chrono::steady_clock::time_point now);
  long suppressed() const { return suppressed_; }

 private:
  std::chrono::milliseconds period_;
  std::chrono::steady_clock::time_point last_{};
  bool any_ = false;
  long waiting_ = 0, suppressed_ = 0;
};

}  // namespace scanlock
