// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// A stamp that is ahead by more than this, and by more than ten periods of the sensor, is of another clock
/// until further stamps agree with it. Also the bound of a gap of unknown length: the motion in a longer one
/// is not predicted.
inline constexpr double kLongestGap = 3.0;  // seconds

/// Decides whether the stamps of scans come from one clock, and how much time passed between two of them. A
/// stamp that disagrees with its neighbours is rejected; three rejected ones in a row that agree with each
/// other are a step of the clock. Stamps by a process and not by the sensor are taken in the order of their
/// arrival. The decisions depend on the stamps alone, so that a replay repeats those of the robot.
class ScanClock {
 public:
  enum class Verdict : std::int8_t {
    kContinues,   ///< the next scan of the clock
    kStepped,     ///< the third in a row of another clock, which is the clock from now on
    kDuplicate,   ///< the stamp of the last scan: rejected, as are the two below
    kBackward,    ///< up to a second earlier than the last scan, by a clock that is regular
    kOtherClock,  ///< farther off, or stamped by another source (Scan::stamped_by_arrival)
  };
  struct Reading {
    Verdict verdict = Verdict::kContinues;
    /// Seconds since the last accepted scan; after a step an estimate, from the rejected scans.
    double elapsed_s = 0;
    /// Upper bound of the seconds; may exceed elapsed_s after a step, or where the clock is irregular.
    double most_elapsed_s = 0;
    std::int64_t last_utime = 0;  ///< stamp of the last accepted scan, microseconds
    /// The stamps rejected lately advance like a second clock, in between accepted ones.
    bool interleaved = false;
  };

  Reading read(const Scan& scan);
  bool accepts(Verdict verdict) const { return verdict <= Verdict::kStepped; }
  /// Seconds between two scans, the median of the last few; 0 before there were two.
  double period_s() const;

 private:
  /// A sequence of stamps that advances like one clock.
  struct Chain {
    std::int64_t first = 0, last = 0;  ///< microseconds
    bool by_arrival = false;
    int scans = 0;  ///< 0: none yet
  };
  bool advances(const Chain& chain, const Scan& scan) const;
  void extend(Chain& chain, const Scan& scan) const;
  Reading accept(const Scan& scan);
  Reading step();
  bool irregular() const;
  bool is_late(const Scan& scan) const;
  double mean_period_s() const;
  double period_quantile_s(double share) const;
  void note_period(double seconds);

  static constexpr int kPeriods = 31, kTooShort = 3;
  std::array<double, kPeriods> periods_{};  ///< seconds between the last accepted scans, a ring buffer
  int periods_noted_ = 0;
  Chain clock_;                  ///< of the accepted scans; its last is the newest stamp
  Chain rejected_;               ///< of the scans rejected in a row
  std::int64_t last_taken_ = 0;  ///< stamp of the last accepted scan, microseconds
  Chain other_;                  ///< of the rejected scans, also with accepted ones in between
};

}  // namespace scanlock
