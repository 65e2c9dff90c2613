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
  const PreparedScan scan;
  CHECK(check.is_trusted(attempt(0.3, 5)));
  CHECK_FALSE(check.is_trusted(attempt(0.56, 5)));
  CHECK_FALSE(check.is_trusted(attempt(0.1, 8)));
  check.distrust(false);
  CHECK(check.distrusted_scans() == 1);
  CHECK(check.is_trusted(attempt(0.3, 5)));
  CHECK_FALSE(check.is_trusted(attempt(0.33, 5)));
  check.trust(kScanPeriod, scan, {Pose::Identity(), Vector6::Zero()}, true);
  CHECK(check.distrusted_scans() == 0);
}

TEST_CASE("after a gap, or for an unusual alignment, the last trusted scan contradicts a wrong pose") {
  const Pose here = Pose::Identity(), other(Eigen::Translation3d(-6, 5, 0));
  const PreparedScan seen_there = scan_at(other, 2);
  AlignmentCheck check;
  check.trust(0, scan_at(here, 1), {here, Vector6::Zero()}, true);
  CHECK_FALSE(check.is_contradicted(kScanPeriod, seen_there, attempt(0)));
  CHECK(check.is_contradicted(5 * kScanPeriod, seen_there, attempt(0)));
  CHECK_FALSE(check.is_contradicted(5 * kScanPeriod, scan_at(here, 3), attempt(0)));
  CHECK(check.is_contradicted(kScanPeriod, seen_there, attempt(0, 4.5)));
  CHECK(check.is_contradicted(kScanPeriod, seen_there, attempt(0, 0, 0.3)));
  Attempt first = attempt(0);
  first.health.short_history = true;
  CHECK_FALSE(check.is_contradicted(5 * kScanPeriod, seen_there, first));
  check.distrust(true);
  CHECK(check.looks_alike());
  CHECK(check.is_contradicted(kScanPeriod, seen_there, attempt(0)));
}

TEST_CASE("a planar scan is contradicted only where the motion is unusual, too") {
  const Pose here = Pose::Identity(), other(Eigen::Translation3d(-6, 5, 0));
  const auto planar_at = [](const Pose& pose, unsigned seed) {
    PreparedScan scan;
    scan.planar = true;
    scan.source = scan.rays = planar_hall_scan(pose, Vector6::Zero(), 0, seed).points;
    return scan;
  };
  AlignmentCheck check;
  check.trust(0, planar_at(here, 1), {here, Vector6::Zero()}, true);
  const PreparedScan there = planar_at(other, 2);
  for (const std::int64_t now : {kScanPeriod, 5 * kScanPeriod}) {
    CHECK(check.is_contradicted(now, there, attempt(0.11)));  // a squared gap of 1.2
    CHECK_FALSE(check.is_contradicted(now, there, attempt(0.09, 4.5, 0.3)));
    CHECK_FALSE(check.is_contradicted(now, planar_at(here, 3), attempt(0.11)));
  }
}

TEST_CASE("after a short gap an unexpected motion has to be confirmed, once the motion is known") {
  AlignmentCheck check;
  check.trust(0, scan_at(Pose::Identity(), 1), {Pose::Identity(), Vector6::Zero()}, true);
  MotionPrior told = attempt(0).prior;  // the prediction by other sensors
  told.mean.pose = Pose(Eigen::Translation3d(0.2, 0, 0));
  for (const double ahead : {0.09, 0.11}) {  // squared gaps of 0.8 and 1.2
    const Attempt there = attempt(ahead);
    CHECK_FALSE(check.is_to_be_confirmed(3 * kScanPeriod, 0.1, there.prior, there));
    CHECK(check.is_to_be_confirmed(4 * kScanPeriod, 0.1, there.prior, there) == (ahead > 0.1));
    CHECK(check.is_to_be_confirmed(4 * kScanPeriod, 0.1, told, there) == (ahead < 0.1));
  }
  Attempt first = attempt(0.3);
  CHECK(check.is_to_be_confirmed(4 * kScanPeriod, 0.1, first.prior, first));
  CHECK_FALSE(check.is_to_be_confirmed(4 * kScanPeriod, 0.4, first.prior, first));  // no scan is missing
  CHECK_FALSE(check.is_to_be_confirmed(13 * kScanPeriod, 0.1, first.prior, first));
  first.health.short_history = true;
  CHECK_FALSE(check.is_to_be_confirmed(4 * kScanPeriod, 0.1, first.prior, first));
}

TEST_CASE("no scan is contradicted by a trusted scan that is no witness, nor after a restart") {
  const Pose here = Pose::Identity();
  const PreparedScan other = scan_at(Pose(Eigen::Translation3d(-6, 5, 0)), 2);
  AlignmentCheck check;
  check.trust(0, scan_at(here, 1), {here, Vector6::Zero()}, false);
  CHECK_FALSE(check.is_contradicted(5 * kScanPeriod, other, attempt(0)));
  check.distrust(false);
  check.restart(here, kScanPeriod);
  CHECK(check.distrusted_scans() == 0);
  CHECK(check.last().utime == kScanPeriod);
  CHECK_FALSE(check.is_contradicted(5 * kScanPeriod, other, attempt(0)));
}
