// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/trusted_scan.hpp"

#include <doctest/doctest.h>

#include "room.hpp"

using namespace scanlock;

namespace {

PreparedScan prepared(const Pose& pose, const Vector6& twist, unsigned seed) {
  PreparedScan scan;
  scan.source = scan.rays = hall_scan(pose, twist, 0, seed).points;
  return scan;
}

}  // namespace

TEST_CASE("a motion that changes from one scan to the next is no contradiction") {
  const Pose here = Pose::Identity();
  const Vector6 before = yaw(-3), now = yaw(3);
  const TrustedScan last = trusted_scan(0, prepared(here, before, 1), {here, before});
  CHECK(contradiction(last, 100000, prepared(here, now, 2), {here, now}) < 0.02);
  // Motion distortion is not removed.
  CHECK(contradiction(last, 100000, prepared(here, now, 2), {here, before}) > 0.05);
}

TEST_CASE("scans of two positions contradict, unless the rays of the first are missing or 4 s old") {
  const Pose here = Pose::Identity(), other(Eigen::Translation3d(-6, 5, 0));
  const PreparedScan first = prepared(here, Vector6::Zero(), 1), second = prepared(other, Vector6::Zero(), 2);
  TrustedScan last = trusted_scan(0, first, {here, Vector6::Zero()});
  CHECK(contradiction(last, 100000, second, {other, Vector6::Zero()}) < 0.02);
  CHECK(contradiction(last, 100000, second, {here, Vector6::Zero()}) > 0.3);
  const double untold = contradiction(last, 4100000, second, {here, Vector6::Zero()});
  CHECK(untold > 0.02);
  CHECK(untold < 0.1);
  last.rays = {};
  CHECK(contradiction(last, 100000, second, {here, Vector6::Zero()}) == untold);
}
