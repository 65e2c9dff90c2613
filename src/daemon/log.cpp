// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/log.hpp"

#include <unistd.h>

#include <cstdlib>

namespace scanlock {

void log_line(LogLevel level, const std::string& text) {
  static const bool to_journal = std::getenv("JOURNAL_STREAM") != nullptr;
  const char* word = level == LogLevel::kError ? "error: " : level == LogLevel::kWarning ? "warning: " : "";
  std::string line = to_journal ? "<" + std::to_string(static_cast<int>(level)) + ">" : "scanlockd: ";
  line += word;
  for (const char c : text) line += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  line += '\n';
  const ssize_t written = write(STDERR_FILENO, line.data(), line.size());
  static_cast<void>(written);  // a failed write to the log does not stop the daemon
}

bool Throttle::allows(std::chrono::steady_clock::time_point now) {
  if (any_ && now - last_ < period_) {
    ++waiting_;
    return false;
  }
  any_ = true;
  last_ = now;
  suppressed_ = waiting_;
  waiting_ = 0;
  return true;
}

}  // namespace scanlock
