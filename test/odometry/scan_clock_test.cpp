// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/scan_clock.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace scanlock;
using Verdict = ScanClock::Verdict;

namespace {

constexpr std::int64_t kSecond = 1000000, kFirstScan = 1700000000 * kSecond;

Scan scan_at(std::int64_t utime, bool by_arrival = false) {
  Scan scan;
  scan.utime = utime;
  scan.stamped_by_arrival = by_arrival;
  return scan;
}

/// A clock that has read `scans` scans of 10 Hz from kFirstScan on.
ScanClock running(int scans) {
  ScanClock clock;
  for (int i = 0; i < scans; ++i) {
    const ScanClock::Reading reading = clock.read(scan_at(kFirstScan + i * kSecond / 10));
    CHECK(reading.verdict == Verdict::kContinues);
    if (i > 0) CHECK(reading.elapsed_s == doctest::Approx(0.1));
  }
  return clock;
}

}  // namespace

TEST_CASE("a single wrong stamp is rejected, and the clock goes on") {
  const std::int64_t last = kFirstScan + 19 * kSecond / 10, next = last + kSecond / 10;
  for (const std::int64_t off :
       {std::int64_t{0}, std::int64_t{1}, std::int64_t{1} << 62, last + 3600 * kSecond, last - 3 * kSecond,
        last + 4 * kSecond, -last, std::numeric_limits<std::int64_t>::min(),
        std::numeric_limits<std::int64_t>::max()}) {
    CAPTURE(off);
    ScanClock clock = running(20);
    CHECK(clock.read(scan_at(off)).verdict == Verdict::kOtherClock);
    const ScanClock::Reading after = clock.read(scan_at(next));
    CHECK(after.verdict == Verdict::kContinues);
    CHECK(after.elapsed_s == doctest::Approx(0.1));
    CHECK(after.most_elapsed_s == after.elapsed_s);
  }
}

TEST_CASE("a scan without a stamp among stamped scans is of another clock, even if its arrival fits") {
  ScanClock clock = running(5);
  CHECK(clock.read(scan_at(kFirstScan + kSecond / 2, true)).verdict == Verdict::kOtherClock);
  CHECK(clock.read(scan_at(kFirstScan + 6 * kSecond / 10)).verdict == Verdict::kContinues);
}

TEST_CASE("three scans in a row that agree on another clock are a step") {
  for (const std::int64_t by :
       {-kSecond / 2, -2 * kSecond, -kFirstScan + kSecond, 5 * kSecond, 86400 * kSecond}) {
    CAPTURE(by);
    ScanClock clock = running(20);
    const std::int64_t first = kFirstScan + 2 * kSecond + by;
    CHECK_FALSE(clock.accepts(clock.read(scan_at(first)).verdict));
    CHECK_FALSE(clock.accepts(clock.read(scan_at(first + kSecond / 10)).verdict));
    const ScanClock::Reading stepped = clock.read(scan_at(first + 2 * kSecond / 10));
    CHECK(stepped.verdict == Verdict::kStepped);
    CHECK(stepped.elapsed_s == doctest::Approx(0.3));
    CHECK(stepped.most_elapsed_s == kLongestGap);
    CHECK(stepped.last_utime == kFirstScan + 19 * kSecond / 10);
    CHECK(clock.read(scan_at(first + 3 * kSecond / 10)).verdict == Verdict::kContinues);
    CHECK(clock.read(scan_at(kFirstScan + 21 * kSecond / 10)).verdict != Verdict::kStepped);
  }
}

TEST_CASE("three stamps that do not agree with each other are no step") {
  ScanClock clock = running(20);
  for (const std::int64_t off : {5 * kSecond, 900 * kSecond, 7 * kSecond, 100 * kSecond})
    CHECK(clock.read(scan_at(kFirstScan + off)).verdict == Verdict::kOtherClock);
  CHECK(clock.read(scan_at(kFirstScan + 2 * kSecond)).verdict == Verdict::kContinues);
}

TEST_CASE("late and repeated scans are distinguished") {
  ScanClock clock = running(20);
  CHECK(clock.read(scan_at(kFirstScan + 19 * kSecond / 10)).verdict == Verdict::kDuplicate);
  CHECK(clock.read(scan_at(kFirstScan + 15 * kSecond / 10)).verdict == Verdict::kBackward);
  CHECK(clock.read(scan_at(kFirstScan + 2 * kSecond)).verdict == Verdict::kContinues);
}

TEST_CASE("a pause is a gap of known length up to three seconds and a step beyond") {
  ScanClock clock = running(20);
  const ScanClock::Reading paused = clock.read(scan_at(kFirstScan + 49 * kSecond / 10));
  CHECK(paused.verdict == Verdict::kContinues);
  CHECK(paused.elapsed_s == doctest::Approx(3.0));
  CHECK(clock.read(scan_at(kFirstScan + 80 * kSecond / 10)).verdict == Verdict::kOtherClock);
}

TEST_CASE("a sensor with a period of 20 s is followed, also over missing scans") {
  ScanClock clock;
  for (int i = 0; i < 5; ++i)
    CHECK(clock.read(scan_at(kFirstScan + 20 * i * kSecond)).verdict == Verdict::kContinues);
  // Three scans are missing.
  CHECK(clock.read(scan_at(kFirstScan + 160 * kSecond)).verdict == Verdict::kContinues);
}

TEST_CASE("a wrong first stamp is given up after two further scans") {
  ScanClock clock;
  clock.read(scan_at(1));
  int rejected = 0;
  for (int i = 0; i < 5; ++i)
    rejected += clock.accepts(clock.read(scan_at(kFirstScan + i * kSecond / 10)).verdict) ? 0 : 1;
  CHECK(rejected == 2);
}

TEST_CASE("two interleaved clocks are detected, and one of them is followed") {
  ScanClock clock = running(5);
  int interleaved = 0;
  for (int i = 5; i < 30; ++i) {
    CHECK(clock.read(scan_at(kFirstScan + i * kSecond / 10)).verdict == Verdict::kContinues);
    const ScanClock::Reading other = clock.read(scan_at(kFirstScan + 12 * kSecond + i * kSecond / 10));
    CHECK(other.verdict == Verdict::kOtherClock);
    interleaved += other.interleaved ? 1 : 0;
  }
  CHECK(interleaved > 10);
  CHECK(interleaved < 20);
}

namespace {

/// Stamps, seconds, of scans measured every 0.2 s: every fourth stamp is 0.3 s late, and every tenth half a
/// second early.
double stamped_s(int i) {
  const double written = 0.2 * i + 0.3 * (i % 4 == 0) + 0.001 * (i % 4);
  return i % 10 == 7 ? written - 0.5 : written;
}

}  // namespace

TEST_CASE("late scans of an irregular clock are taken in the order of their arrival") {
  ScanClock clock;
  double elapsed = 0;
  for (int i = 0; i < 240; ++i) {
    CAPTURE(i);
    const std::int64_t utime = kFirstScan + static_cast<std::int64_t>(1e6 * stamped_s(i));
    const ScanClock::Reading reading = clock.read(scan_at(utime));
    if (i < 60) continue;
    CHECK(reading.verdict == Verdict::kContinues);
    CHECK(reading.elapsed_s == doctest::Approx(0.2).epsilon(0.1));
    CHECK(reading.most_elapsed_s >= reading.elapsed_s);
    elapsed += reading.elapsed_s;
    CHECK(clock.read(scan_at(utime)).verdict == Verdict::kDuplicate);
    CHECK(clock.read(scan_at(utime - 2 * kSecond)).verdict == Verdict::kOtherClock);
  }
  CHECK(elapsed == doctest::Approx(36).epsilon(0.02));
}

TEST_CASE("an irregular clock that steps back by 0.9 s is followed") {
  ScanClock clock;
  for (int i = 0; i < 200; ++i) {
    const double back = i < 100 ? 0 : 0.9;
    const ScanClock::Reading reading =
        clock.read(scan_at(kFirstScan + static_cast<std::int64_t>(1e6 * (stamped_s(i) - back))));
    CAPTURE(i);
    if (i < 60) continue;
    CHECK(clock.accepts(reading.verdict));
    CHECK(reading.elapsed_s > 0.1);
    CHECK(reading.elapsed_s < 0.3);
  }
}
