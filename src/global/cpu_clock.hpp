// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <ctime>

namespace scanlock {

/// CPU time of the calling thread, milliseconds.
class CpuClock {
 public:
  /// Milliseconds since the last call, or since construction.
  double lap() {
    const double now = read(), ms = now - last_;
    last_ = now;
    return ms;
  }

 private:
  static double read() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
  }
  double last_ = read();
};

}  // namespace scanlock
