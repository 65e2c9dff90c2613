// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/statistics.hpp"

#include <doctest/doctest.h>

#include "../contains.hpp"
#include "daemon/log.hpp"
#include "daemon/silence.hpp"

using namespace scanlock;
using std::chrono::milliseconds;
using std::chrono::seconds;

namespace {

const auto kStart = std::chrono::steady_clock::time_point(seconds(1000));

TrackedScan unused(ScanVerdict verdict) {
  TrackedScan tracked;
  tracked.verdict = verdict;
  return tracked;
}

}  // namespace

TEST_CASE("percentiles are values that occurred") {
  CHECK(percentile({}, 0.5) == 0);
  CHECK(percentile({7}, 0.99) == 7);
  CHECK(percentile({3, 1, 2}, 0.5) == 2);
  std::vector<double> hundred;
  for (int i = 100; i > 0; --i) hundred.push_back(i);
  CHECK(percentile(hundred, 0.5) == 50);
  CHECK(percentile(hundred, 0.95) == 95);
  CHECK(percentile(hundred, 0.99) == 99);
}

TEST_CASE("a rate is that of the last five seconds") {
  RateMeter meter;
  CHECK(meter.per_second(kStart) == 0);
  for (int i = 0; i <= 100; ++i) meter.add(kStart + milliseconds(100 * i));
  CHECK(meter.per_second(kStart + seconds(10)) == doctest::Approx(10));
  CHECK(meter.per_second(kStart + seconds(20)) == 0);
}

TEST_CASE("each fault and verdict has its own counter") {
  Statistics statistics;
  statistics.count_fault(DecodeFault::kTruncated, "a");
  statistics.count_fault(DecodeFault::kUnknownType, "b");
  statistics.count_fault(DecodeFault::kBadSize, "c");
  statistics.count_fault(DecodeFault::kBadField, "d");
  CHECK(statistics.report().counters.last_error == "d");
  statistics.count_verdict(unused(ScanVerdict::kTracked));
  statistics.count_verdict(unused(ScanVerdict::kEmpty));
  statistics.count_verdict(unused(ScanVerdict::kDuplicateTime));
  statistics.count_verdict(unused(ScanVerdict::kBackwardTime));
  statistics.count_verdict(unused(ScanVerdict::kOtherClock));
  const Counters counters = statistics.report().counters;
  CHECK(counters.truncated == 1);
  CHECK(counters.unknown_type == 1);
  CHECK(counters.bad_size == 1);
  CHECK(counters.bad_field == 1);
  CHECK(counters.empty == 1);
  CHECK(counters.duplicate_time == 1);
  CHECK(counters.backward_time == 1);
  CHECK(counters.clock == 1);
  CHECK(counters.rejected() == 8);
  CHECK(counters.last_error.find("was not used") != std::string::npos);
}

TEST_CASE("latency percentiles cover only the most recent poses") {
  Statistics statistics;
  for (int i = 0; i < 1000; ++i) statistics.count_published(500);
  for (int i = 0; i < 1000; ++i) statistics.count_published(10);
  CHECK(statistics.report().latency.p99_ms == 10);
  CHECK(statistics.report().counters.used == 2000);
}

TEST_CASE("silence is reported with its reason and at doubling intervals") {
  SilenceWatch watch("LIDAR", 5, kStart);
  Counters counters;
  CHECK_FALSE(watch.look(counters, kStart + seconds(4)));
  const auto first = watch.look(counters, kStart + seconds(5));
  REQUIRE(first);
  CHECK(first->warning);
  CHECK(contains(first->text, "nothing came on LIDAR"));
  CHECK_FALSE(watch.look(counters, kStart + seconds(9)));
  CHECK(watch.look(counters, kStart + seconds(10)));
  CHECK_FALSE(watch.look(counters, kStart + seconds(19)));

  counters.kernel_drops = 40;
  CHECK(contains(watch.look(counters, kStart + seconds(20))->text, "the kernel dropped 40"));
  counters.received = counters.unknown_type = 3;
  counters.last_error = "LIDAR: fingerprint 0x1234";
  CHECK(contains(watch.look(counters, kStart + seconds(40))->text, "3 messages came and were rejected"));

  counters.received = 4;
  const auto back = watch.look(counters, kStart + seconds(41));
  REQUIRE(back);
  CHECK_FALSE(back->warning);
  CHECK(contains(back->text, "scans are back after 41.0 s"));
  CHECK_FALSE(watch.look(counters, kStart + seconds(45)));
  CHECK(watch.look(counters, kStart + seconds(46)));
  CHECK(contains(SilenceWatch("LIDAR.*", 5, kStart).look({}, kStart + seconds(5))->text, "not patterns"));
}

TEST_CASE("a throttle allows one event in each period and counts the suppressed events") {
  Throttle throttle(seconds(10));
  CHECK(throttle.allows(kStart));
  CHECK(throttle.suppressed() == 0);
  CHECK_FALSE(throttle.allows(kStart + seconds(1)));
  CHECK_FALSE(throttle.allows(kStart + seconds(9)));
  CHECK(throttle.allows(kStart + seconds(10)));
  CHECK(throttle.suppressed() == 2);
}
