// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/scan_clock.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace scanlock {
namespace {

constexpr double kLongestPeriod = 60;   // seconds that a stamp may be ahead before a period is known
constexpr double kPeriodsAhead = 10;    // a sensor of a long period may well miss a few scans
constexpr double kLate = 1.0;           // seconds by which a scan may be delayed on its way
constexpr int kScansOfAStep = 3;        // rejected in a row
constexpr int kScansOfAnotherOne = 10;  // rejected, with accepted ones in between: another publisher

/// Seconds from b to a. The difference of hostile stamps may exceed an int64, so that it is computed in
/// doubles; that of near ones is exact.
double difference_s(std::int64_t a, std::int64_t b) {
  const double far = static_cast<double>(a) - static_cast<double>(b);
  return std::abs(far) > 1e15 ? 1e-6 * far : 1e-6 * static_cast<double>(a - b);
}

}  // namespace

double ScanClock::period_s() const {
  return period_quantile_s(0.5);
}

double ScanClock::period_quantile_s(double share) const {
  std::array<double, kPeriods> sorted = periods_;
  const int known = std::min(periods_noted_, kPeriods);
  std::sort(sorted.begin(), sorted.begin() + known);
  return known > 0 ? sorted[static_cast<std::size_t>(share * known)] : 0.0;
}

/// No sensor takes two scans within a quarter of its period: stamps so near each other were set by a process
/// when it got to the scan, and give the times of scans only on average. (Longer intervals are scans that
/// were lost.)
bool ScanClock::irregular() const {
  if (periods_noted_ < kPeriods) return false;
  const double shortest = 0.25 * period_quantile_s(0.75);
  return std::count_if(periods_.begin(), periods_.end(), [&](double s) { return s < shortest; }) >= kTooShort;
}

double ScanClock::mean_period_s() const {
  return std::accumulate(periods_.begin(), periods_.end(), 0.0) / kPeriods;
}

void ScanClock::note_period(double seconds) {
  periods_[static_cast<std::size_t>(periods_noted_ % kPeriods)] = seconds;
  periods_noted_ = periods_noted_ + 1 < 2 * kPeriods ? periods_noted_ + 1 : kPeriods;
}

bool ScanClock::advances(const Chain& chain, const Scan& scan) const {
  const double ahead = difference_s(scan.utime, chain.last);
  const double longest =
      periods_noted_ > 0 ? std::max(kLongestGap, kPeriodsAhead * period_s()) : kLongestPeriod;
  return chain.scans > 0 && chain.by_arrival == scan.stamped_by_arrival && ahead > 0 && ahead <= longest;
}

void ScanClock::extend(Chain& chain, const Scan& scan) const {
  if (!advances(chain, scan)) chain = {scan.utime, scan.utime, scan.stamped_by_arrival, 0};
  chain.last = scan.utime;
  ++chain.scans;
}

/// Scans arrive in the order in which they were taken, however late a process stamped each of them. A scan
/// stamped before its predecessor by no more than kLate is the next scan of an irregular clock.
bool ScanClock::is_late(const Scan& scan) const {
  const double behind = difference_s(clock_.last, scan.utime);
  return clock_.by_arrival == scan.stamped_by_arrival && behind > 0 && behind <= kLate && irregular();
}

ScanClock::Reading ScanClock::accept(const Scan& scan) {
  Reading reading;
  reading.last_utime = last_taken_;
  const bool late = is_late(scan);
  if (clock_.scans > 0) {
    // Measured from the newest stamp, so that the periods add up to the time that passed.
    reading.elapsed_s = reading.most_elapsed_s = late ? 0.0 : difference_s(scan.utime, clock_.last);
    note_period(reading.elapsed_s);
    if (late || irregular()) {
      reading.elapsed_s = mean_period_s();
      reading.most_elapsed_s = std::max(reading.elapsed_s, reading.most_elapsed_s);
    }
  }
  if (late)
    ++clock_.scans;
  else
    extend(clock_, scan);
  last_taken_ = scan.utime;
  rejected_ = {};
  return reading;
}

ScanClock::Reading ScanClock::step() {
  Reading reading;
  reading.verdict = Verdict::kStepped;
  reading.last_utime = last_taken_;
  const double seen = difference_s(rejected_.last, rejected_.first);
  const double period = periods_noted_ > 0 ? period_s() : seen / (kScansOfAStep - 1);
  reading.elapsed_s = irregular() ? kScansOfAStep * mean_period_s() : seen + period;
  // Irregular stamps jump without any step of the clock.
  reading.most_elapsed_s = irregular() ? reading.elapsed_s : std::max(reading.elapsed_s, kLongestGap);
  clock_ = rejected_;
  last_taken_ = clock_.last;
  rejected_ = other_ = {};
  return reading;
}

ScanClock::Reading ScanClock::read(const Scan& scan) {
  Reading reading;
  reading.last_utime = last_taken_;
  const double behind = difference_s(clock_.last, scan.utime);
  const bool same = clock_.by_arrival == scan.stamped_by_arrival;
  if (clock_.scans > 0 && same && (behind == 0 || scan.utime == last_taken_)) {
    reading.verdict = Verdict::kDuplicate;
    return reading;
  }
  if (clock_.scans == 0 || advances(clock_, scan) || is_late(scan)) return accept(scan);
  extend(rejected_, scan);
  extend(other_, scan);
  if (rejected_.scans == kScansOfAStep) return step();
  reading.verdict = same && behind > 0 && behind <= kLate ? Verdict::kBackward : Verdict::kOtherClock;
  reading.interleaved = other_.scans >= kScansOfAnotherOne;
  return reading;
}

}  // namespace scanlock
