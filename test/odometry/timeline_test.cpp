// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/timeline.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <string>
#include <utility>

#include "../contains.hpp"

using namespace scanlock;

namespace {

constexpr std::int64_t kOneSecond = 1000000, kStampPeriod = kOneSecond / 10,
                       kFirstStamp = 1700000000 * kOneSecond;

struct Taken {
  bool taken;
  TrackedScan tracked;
};

Taken take(Timeline* timeline, std::int64_t stamp) {
  Scan scan;
  scan.utime = stamp;
  Taken result;
  result.taken = timeline->take(scan, &result.tracked);
  return result;
}

/// A timeline that has taken scans at 10 Hz from kFirstStamp on.
Timeline started(int scans) {
  Timeline timeline;
  for (int i = 0; i < scans; ++i) CHECK(take(&timeline, kFirstStamp + i * kStampPeriod).taken);
  return timeline;
}

}  // namespace

TEST_CASE("the time is the stamp while the clock is regular") {
  Timeline timeline = started(1);
  CHECK(timeline.now() == kFirstStamp);
  CHECK(timeline.elapsed_s() == 0);
  timeline = started(20);
  CHECK(timeline.now() == kFirstStamp + 19 * kStampPeriod);
  CHECK(timeline.stamp() == timeline.now());
  CHECK(timeline.elapsed_s() == doctest::Approx(0.1));
  CHECK(timeline.most_elapsed_s() == timeline.elapsed_s());
  CHECK(timeline.since_s(kFirstStamp) == doctest::Approx(1.9));
  CHECK(take(&timeline, kFirstStamp + 39 * kStampPeriod).taken);  // a gap
  CHECK(timeline.now() == timeline.stamp());
  CHECK(timeline.elapsed_s() == doctest::Approx(2));
}

TEST_CASE("a rejected stamp does not change the time, and the reason names the stamp before it") {
  Timeline timeline = started(20);
  const std::int64_t last = kFirstStamp + 19 * kStampPeriod;
  const std::pair<std::int64_t, ScanVerdict> kBad[] = {{last, ScanVerdict::kDuplicateTime},
                                                       {last - 5 * kStampPeriod, ScanVerdict::kBackwardTime},
                                                       {last + 3600 * kOneSecond, ScanVerdict::kOtherClock}};
  for (const auto& [stamp, verdict] : kBad) {
    const Taken bad = take(&timeline, stamp);
    CHECK_FALSE(bad.taken);
    CHECK(bad.tracked.verdict == verdict);
    CHECK(contains(bad.tracked.why, std::to_string(last)));
    CHECK(timeline.now() == last);
    CHECK(timeline.stamp() == last);
    CHECK(timeline.elapsed_s() == doctest::Approx(0.1));
  }
}

TEST_CASE("stamps in nanoseconds are recognised") {
  Timeline timeline;
  CHECK(take(&timeline, 1000 * kFirstStamp).taken);
  const Taken second = take(&timeline, 1000 * (kFirstStamp + kStampPeriod));
  CHECK_FALSE(second.taken);
  CHECK(contains(second.tracked.why, "are these nanoseconds?"));
}

TEST_CASE("a clock step in either direction advances the time by the longest gap that it may hide") {
  for (const std::int64_t by : {-86400 * kOneSecond, 86400 * kOneSecond}) {
    Timeline timeline = started(20);
    const std::int64_t last = kFirstStamp + 19 * kStampPeriod;
    CHECK_FALSE(take(&timeline, last + by + kStampPeriod).taken);
    CHECK_FALSE(take(&timeline, last + by + 2 * kStampPeriod).taken);
    const Taken third = take(&timeline, last + by + 3 * kStampPeriod);
    CHECK(third.taken);
    CHECK(third.tracked.clock_step_from == last);
    CHECK(timeline.stamp() == last + by + 3 * kStampPeriod);
    CHECK(timeline.elapsed_s() == doctest::Approx(0.3));
    CHECK(timeline.most_elapsed_s() == kLongestGap);
    CHECK(timeline.now() == last + 3 * kOneSecond);
    const Taken next = take(&timeline, last + by + 4 * kStampPeriod);
    CHECK_FALSE(next.tracked.clock_step_from);
    CHECK(timeline.now() == last + 3 * kOneSecond + kStampPeriod);
  }
}

TEST_CASE("all times are later than those of an earlier run, and the stamps if these are later still") {
  Timeline timeline;
  timeline.start_after(kFirstStamp);
  CHECK(take(&timeline, 1).taken);
  CHECK(timeline.now() == kFirstStamp + 3600 * kOneSecond);
  CHECK(take(&timeline, 1 + kStampPeriod).taken);
  CHECK(timeline.now() == kFirstStamp + 3600 * kOneSecond + kStampPeriod);
  timeline = {};
  timeline.start_after(1);
  CHECK(take(&timeline, kFirstStamp).taken);
  CHECK(timeline.now() == kFirstStamp);
  timeline = {};
  timeline.start_after(std::numeric_limits<std::int64_t>::max());
  CHECK(take(&timeline, kFirstStamp).taken);
  CHECK(timeline.now() > kFirstStamp);
}
