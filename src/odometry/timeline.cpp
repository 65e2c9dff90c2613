// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/timeline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace scanlock {
namespace {

constexpr std::int64_t kYear2096 = 4'000'000'000'000'000;  // microseconds

ScanVerdict rejection(ScanClock::Verdict verdict) {
  if (verdict == ScanClock::Verdict::kDuplicate) return ScanVerdict::kDuplicateTime;
  if (verdict == ScanClock::Verdict::kBackward) return ScanVerdict::kBackwardTime;
  return ScanVerdict::kOtherClock;
}

}  // namespace

bool Timeline::take(const Scan& scan, TrackedScan* tracked) {
  const ScanClock::Reading reading = clock_.read(scan);
  if (!clock_.accepts(reading.verdict)) {
    tracked->verdict = rejection(reading.verdict);
    tracked->why = std::string(to_string(tracked->verdict)) + ", the scan before it has " +
                   std::to_string(reading.last_utime) + (scan.stamped_by_arrival ? "; it has no stamp" : "") +
                   (scan.utime > kYear2096 ? "; microseconds are expected: are these nanoseconds?" : "");
    tracked->interleaved = reading.interleaved;
    return false;
  }
  if (reading.verdict == ScanClock::Verdict::kStepped) tracked->clock_step_from = reading.last_utime;
  stamp_ = scan.utime;
  elapsed_s_ = reading.elapsed_s;
  most_elapsed_s_ = reading.most_elapsed_s;
  now_ = started_ ? now_ + static_cast<std::int64_t>(std::llround(most_elapsed_s_ / 1e-6))
                  : std::max(now_, scan.utime);
  started_ = true;
  return true;
}

void Timeline::start_after(std::int64_t time) {
  constexpr std::int64_t kHour = 3600000000, kLatest = std::numeric_limits<std::int64_t>::max() / 2;
  now_ = std::min(time, kLatest) + kHour;
}

}  // namespace scanlock
