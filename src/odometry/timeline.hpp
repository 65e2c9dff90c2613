// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "odometry/scan_clock.hpp"
#include "odometry/tracked_scan.hpp"

namespace scanlock {

/// The time of a tracker, which never goes back. It decides about each scan, by the stamps alone:
/// - whether it is the next scan of the sensor's clock (ScanClock); any other is rejected;
/// - its time, now(). The first scan has its stamp as its time, every further one the time of the scan
///   before it plus the difference of their stamps. Where the clock steps, or is irregular, the difference
///   is not known, and most_elapsed_s() is added. Until then times are equal to the stamps; afterwards only
///   their intervals are those of the sensor.
class Timeline {
 public:
  /// False for a rejected scan: times stay as they are, and `tracked` gets the verdict and the reason. A step
  /// of the clock is noted in `tracked`, too.
  bool take(const Scan& scan, TrackedScan* tracked);

  /// Time of the last accepted scan, microseconds.
  std::int64_t now() const { return now_; }
  /// The stamp of the same scan, microseconds.
  std::int64_t stamp() const { return stamp_; }
  /// Seconds from a time of this timeline to now().
  double since_s(std::int64_t time) const { return 1e-6 * static_cast<double>(now_ - time); }
  /// Seconds between the last two accepted scans, 0 before there were two: the likeliest number, and an upper
  /// bound, which may be larger where the clock stepped or is irregular.
  double elapsed_s() const { return elapsed_s_; }
  double most_elapsed_s() const { return most_elapsed_s_; }

  /// To be called before any scan: all times will be at least an hour later than `time`, the last one of an
  /// earlier run, whatever the clocks of the two runs show. Microseconds.
  void start_after(std::int64_t time);

 private:
  ScanClock clock_;
  bool started_ = false;
  std::int64_t now_ = 0, stamp_ = 0;
  double elapsed_s_ = 0, most_elapsed_s_ = 0;
};

}  // namespace scanlock
