// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "odometry/scan_clock.hpp"
#include "odometry/tracked_scan.hpp"

namespace scanlock {

/// The time of a tracker, which never goes back. It decides two things of each scan, by the stamps alone:
/// - whether it is the next scan of the sensor's clock (ScanClock); any other is rejected;
/// - its time, now(). The first scan has its stamp, every further one the time of the scan before it plus the
///   seconds that have passed: the difference of the stamps. Where the clock steps, or is irregular, that is
///   not known, and most_elapsed_s() is added. So the time equals the stamp until then, and afterwards
///   intervals, not instants, are those of the sensor.
class Timeline {
 public:
  /// False for a rejected scan: times stay as they are, and `tracked` says why. `tracked` also tells of a
  /// step.
  bool take(const Scan& scan, TrackedScan* tracked);

  /// Of the last scan that was taken, microseconds.
  std::int64_t now() const { return now_; }
  /// The same as its sensor stamped it.
  std::int64_t stamp() const { return stamp_; }
  /// Seconds from a time of this timeline to now().
  double since_s(std::int64_t time) const { return 1e-6 * static_cast<double>(now_ - time); }
  /// Seconds between the last two scans that were taken, 0 before there were two: the likeliest number, and
  /// an upper bound, which is larger where the clock stepped or is irregular.
  double elapsed_s() const { return elapsed_s_; }
  double most_elapsed_s() const { return most_elapsed_s_; }
  /// Seconds between two scans of this sensor, as a rule (see ScanClock).
  double period_s() const { return clock_.period_s(); }

  /// Before any scan: all times are an hour later than `time`, of an earlier run, or more, whatever the clock
  /// of either run said.
  void start_after(std::int64_t time);

 private:
  ScanClock clock_;
  bool started_ = false;
  std::int64_t now_ = 0, stamp_ = 0;
  double elapsed_s_ = 0, most_elapsed_s_ = 0;
};

}  // namespace scanlock
