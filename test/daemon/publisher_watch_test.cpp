// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/publisher_watch.hpp"

#include <doctest/doctest.h>

using namespace scanlock;

namespace {

/// Whether the watch reported interleaved scans for any of the counts.
bool told(std::initializer_list<std::int32_t> first_counts, int scans, bool sectors = false, int each = 1) {
  CountWatch watch;
  bool any = false;
  for (int i = 0; i < scans; ++i) {
    for (const std::int32_t first : first_counts) {
      for (int k = 0; k < each; ++k) any = watch.interleaves(first == 0 ? 0 : first + i, sectors) || any;
    }
  }
  return any;
}

TrackedScan scan(PoseMethod method) {
  TrackedScan tracked;
  tracked.method = method;
  return tracked;
}

}  // namespace

TEST_CASE("message counts of two alternating publishers are distinguished from those of one") {
  CHECK(told({100, 5000}, 20));
  CHECK(told({100, 100}, 20));  // both publishers started at the same time
  CHECK(told({100, 5000}, 20, true));
  CHECK_FALSE(told({100}, 100));
  CHECK_FALSE(told({0}, 100));              // a type without a count
  CHECK_FALSE(told({100}, 100, true, 30));  // 30 sectors a scan
  CHECK_FALSE(told({100, 5000}, 4));        // too few scans to decide
}

TEST_CASE("scans that alternate between tracked and predicted are reported once in 500 scans") {
  PublisherWatch watch;
  int named = 0;
  for (int i = 0; i < 500; ++i)
    named += watch.look(scan(i % 2 == 0 ? PoseMethod::kIcp : PoseMethod::kPredicted)) ? 1 : 0;
  CHECK(named == 1);
}

TEST_CASE(
    "a robot that alternates between 25 tracked and 25 predicted scans is not reported as two publishers") {
  PublisherWatch watch;
  for (int i = 0; i < 500; ++i)
    CHECK_FALSE(watch.look(scan(i % 50 < 25 ? PoseMethod::kIcp : PoseMethod::kPredicted)));
}
