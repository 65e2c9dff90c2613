// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/alignment_check.hpp"

#include <doctest/doctest.h>

#include "room.hpp"

using namespace scanlock;

namespace {

constexpr std::int64_t kScanPeriod = 100000;  // microseconds

/// The alignment of a scan on known ground with the usual energy, `metres` ahead of a prediction whose
/// standard deviations are 0.1 m, 0.1 rad, 1 m/s and 1 rad/s.
Attempt attempt(double metres, double score = 0, double share = 0.9) {
  Attempt result;
  Vector12 information;
  information << Vector6::Constant(100), Vector6::Constant(1);
  result.prior.information = information.asDiagonal();
  result.alignment.moving.pose = Pose(Eigen::Translation3d(metres, 0, 0));
  result.health.energy = 0.1;
  result.health.overlap = 0.95;
  result.health.short_history = false;
  result.health.score = score;
  result.health.inliers = 1000;
  result.health.inlier_ratio = share;
  result.health.median_inlier_ratio = 0.9;
  return result;
}

PreparedScan scan_at(const Pose& pose, unsigned seed) {
  PreparedScan scan;
  scan.source = scan.rays = hall_scan(pose, Vector6::Zero(), 0, seed).points;
  return scan;
}

}  // namespace

TEST_CASE("an alignment near its prediction is plausible, whatever its inlier ratio") {
  AlignmentCheck check;
  for (const double share : {0.9, 0.3}) {
    CHECK(check.is_plausible(attempt(0.54, 0, share)));
    CHECK_FALSE(check.is_plausible(attempt(0.56, 0, share)));  // a squared gap of 31
  }
  check.distrust(false);
  CHECK(check.is_plausible(attempt(0.31)));
  CHECK_FALSE(check.is_plausible(attempt(0.33)));  // a squared gap of 11
}

TEST_CASE("an alignment is trusted if its z-score is low and it is plausible") {
  AlignmentCheck check;
  CHECK(check.is_trusted(attempt(0.3, 5)));
  CHECK_FALSE(check.is_trusted(attempt(0.56, 5)));
  CHECK_FALSE(check.is_trusted(attempt(0.1, 8)));
  check.distrust(false);
  CHECK(check.is_trusted(attempt(0.3, 5)));
  CHECK_FALSE(check.is_trusted(attempt(0.33, 5)));
}

TEST_CASE("distrusted scans are counted until the next trusted one") {
  AlignmentCheck check;
  check.distrust(false);
  CHECK_FALSE(check.looks_alike());
  check.distrust(true);
  CHECK(check.distrusted_scans() == 2);
  CHECK(check.looks_alike());
  check.trust(kScanPeriod, PreparedScan(), {Pose::Identity(), Vector6::Zero()}, true);
  CHECK(check.distrusted_scans() == 0);
  CHECK_FALSE(check.looks_alike());
}

TEST_CASE("a kidnap is told by the contradiction, the motion and the inlier ratio together") {
  const Pose here = Pose::Identity(), other(Eigen::Translation3d(-6, 5, 0));
  for (const bool planar : {false, true}) {
    const auto scan = [&](const Pose& pose, unsigned seed) {
      PreparedScan result;
      result.planar = planar;
      result.source = result.rays = planar ? planar_hall_scan(pose, Vector6::Zero(), 0, seed).points
                                           : hall_scan(pose, Vector6::Zero(), 0, seed).points;
      return result;
    };
    AlignmentCheck check;
    check.trust(0, scan(here, 1), {here, Vector6::Zero()}, true);
    const PreparedScan seen_here = scan(here, 3), seen_there = scan(other, 2);
    const auto is_kidnapped = [&](const PreparedScan& seen, const Attempt& by,
                                  std::int64_t now = kScanPeriod) {
      return check.is_kidnapped(now, seen, by.prior, by);
    };
    CHECK(is_kidnapped(seen_there, attempt(0.25)));
    CHECK(is_kidnapped(seen_there, attempt(0.1, 0, 0.6)));
    CHECK(is_kidnapped(seen_there, attempt(0.1), 12 * kScanPeriod));
    // Two of the three do not suffice.
    CHECK_FALSE(is_kidnapped(seen_here, attempt(0.25, 0, 0.6)));
    CHECK_FALSE(is_kidnapped(seen_there, attempt(0)));
    CHECK_FALSE(is_kidnapped(seen_here, attempt(0, 4.5, 0.3)));
    const Attempt there = attempt(0.25);
    MotionPrior told = there.prior;  // other sensors may predict the motion, or one of their own
    told.mean = there.alignment.moving;
    CHECK_FALSE(check.is_kidnapped(kScanPeriod, seen_there, told, there));
    told.mean.pose = Pose(Eigen::Translation3d(3, 0, 0));
    CHECK(check.is_kidnapped(kScanPeriod, seen_there, told, there));
    CHECK_FALSE(check.is_kidnapped(kScanPeriod, seen_here, told, attempt(0)));
    Attempt first = attempt(0.25);
    first.health.short_history = true;
    CHECK_FALSE(is_kidnapped(seen_there, first));
    // After a scan that spoke for a kidnap the next one needs less evidence.
    check.distrust(true);
    CHECK(is_kidnapped(seen_there, attempt(0)));
    CHECK_FALSE(is_kidnapped(seen_here, attempt(0)));
  }
}

TEST_CASE("a trusted scan that is no witness contradicts nothing, nor does any after a restart") {
  const Pose here = Pose::Identity();
  const PreparedScan other = scan_at(Pose(Eigen::Translation3d(-6, 5, 0)), 2);
  const Attempt there = attempt(0.25);
  AlignmentCheck check;
  check.trust(0, scan_at(here, 1), {here, Vector6::Zero()}, false);
  CHECK_FALSE(check.is_kidnapped(kScanPeriod, other, there.prior, there));
  check.distrust(false);
  check.restart(here, kScanPeriod);
  CHECK(check.distrusted_scans() == 0);
  CHECK(check.last().utime == kScanPeriod);
  CHECK_FALSE(check.is_kidnapped(2 * kScanPeriod, other, there.prior, there));
}
