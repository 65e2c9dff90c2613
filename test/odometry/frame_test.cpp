// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "framed_tracker.hpp"
#include "geometry/angles.hpp"
#include "room.hpp"

using namespace scanlock;

namespace {

/// The tracked scans of a drive of one second, and of another second after a kidnap.
std::vector<TrackedScan> followed(const Frame& frame) {
  FramedTracker tracker(TrackerConfig{}, frame);
  PlaceFinder finder;
  std::vector<TrackedScan> all;
  Vector6 velocity = yaw(0.1);
  velocity[0] = 1;
  for (int i = 0; i < 75; ++i) {
    const Pose pose = i < 50 ? at(-8, 0, 0) * se3_exp(0.1 * i * velocity)
                             : at(-3, -2, 150 * kDegree) * se3_exp(0.1 * (i - 50) * velocity);
    all.push_back(
        tracker.track(hall_scan(pose, velocity, 1000000 + 100000 * i, static_cast<unsigned>(i), 0.1, 3000)));
    if (const auto request = tracker.take_request()) tracker.give(finder.find(*request));
  }
  return all;
}

}  // namespace

TEST_CASE("the origin of the map and its time change no state and no pose" *
          doctest::test_suite("long drives")) {
  const std::vector<TrackedScan> near = followed(Frame{}), far = followed(far_frame());
  REQUIRE(near.size() == far.size());
  int global = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    CAPTURE(i);
    CHECK(near[i].utime == far[i].utime);
    CHECK(near[i].state == far[i].state);
    CHECK(near[i].method == far[i].method);
    CHECK(near[i].epoch == far[i].epoch);
    const Vector6 apart = se3_log(near[i].map_from_body.inverse() * far[i].map_from_body);
    CHECK(apart.norm() < 1e-6);
    REQUIRE(near[i].recovery.has_value() == far[i].recovery.has_value());
    if (!near[i].recovery) continue;
    CHECK(near[i].recovery->accepted == far[i].recovery->accepted);
    if (!near[i].recovery->accepted) continue;
    CHECK(
        se3_log(near[i].recovery->map_from_predicted.inverse() * far[i].recovery->map_from_predicted).norm() <
        0.1);
  }
  for (const TrackedScan& tracked : near) global += tracked.method == PoseMethod::kGlobal ? 1 : 0;
  CHECK(global == 1);
}
