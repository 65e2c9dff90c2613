// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// A stamp farther ahead than this, or than ten periods of the sensor, is of another clock until others agree
/// with it. Also the bound of a gap of unknown length, for what happened in a longer one is not predicted.
inline constexpr double kLongestGap = 3.0;  // seconds

/// Whether stamps of scans come from one clock, and how much time passed between two of them. A stamp that
/// disagrees with its neighbours is rejected; three in a row that agree with each other on another clock are
/// a step of the clock. Stamps that are those of a process and not of the sensor are taken in the order in
/// which they arrive. By the stamps alone, so that a replay comes to what the robot came to.
class ScanClock {
 public:
  enum class Verdict : std::int8_t {
    kContinues,   ///< the next scan of the clock
    kStepped,     ///< the third in a row of another clock, which is the clock from now on
    kDuplicate,   ///< the stamp of the last scan: rejected, as are the two below
    kBackward,    ///< up to a second earlier than the last scan, by a clock that is regular
    kOtherClock,  ///< farther off, or stamped in another way
  };
  struct Reading {
    Verdict verdict = Verdict::kContinues;
    /// Seconds since the last scan that was taken; after a step a guess, from how many scans came since.
    double elapsed_s = 0;
    /// At most so many seconds: more than elapsed_s after a step.
    double most_elapsed_s = 0;
    std::int64_t last_utime = 0;  ///< of the last scan that was taken
    /// The stamps rejected lately advance as a clock of their own, between those that are taken.
    bool interleaved = false;
  };

  Reading read(const Scan& scan);
  bool accepts(Verdict verdict) const { return verdict <= Verdict::kStepped; }
  /// Seconds between two scans, the median of the last few; 0 before there were two.
  double period_s() const;

 private:
  /// Stamps that advance as a clock does.
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
  std::array<double, kPeriods> periods_{};  ///< the last ones between two scans that were taken, a ring
  int periods_noted_ = 0;
  Chain clock_;                  ///< of the scans that are taken; its last is the newest stamp
  Chain rejected_;               ///< of the scans rejected in a row
  std::int64_t last_taken_ = 0;  ///< stamp of the last scan that was taken, microseconds
  Chain other_;                  ///< of the scans rejected, with others taken in between
};

}  // namespace scanlock
