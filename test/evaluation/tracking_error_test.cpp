// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/tracking_error.hpp"

#include <doctest/doctest.h>

using namespace scanlock;

namespace {

Pose at(double x, double y) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x, y, 0);
  return pose;
}

/// 20 s along a bend at 10 Hz, from 10 m/s on; the estimate is 0.1 m off, alternately to either side, and
/// reports TRACKING.
struct BendingDrive {
  Trajectory truth, estimate;
  std::vector<StampedState> states;

  BendingDrive() {
    for (int i = 0; i < 200; ++i) {
      const double time = 100 + 0.1 * i, x = i, y = 0.005 * i * i;
      truth.push_back({time, at(x, y)});
      estimate.push_back({time, at(x, y + (i % 2 == 0 ? 0.1 : -0.1))});
      states.push_back({time, TrackingState::kTracking});
    }
  }
  void say(int from, int to, TrackingState state) {
    for (int i = from; i < to; ++i) states[i].state = state;
  }
  /// The true poses jump by 8 m to the side at second 10; those of the estimate at scan `back`.
  void kidnap(int back) {
    for (int i = 100; i < 200; ++i) truth[i].pose.translation().y() += 8;
    for (int i = back; i < 200; ++i) estimate[i].pose.translation().y() += 8;
  }
  SplitErrors split() const {
    const PosePairs pairs = match_by_time(estimate, truth);
    const KidnapReport report = examine_kidnaps(truth, pairs, states, Overlay::kNone);
    return split_errors(pairs, states, report, Overlay::kNone);
  }
};

}  // namespace

TEST_CASE("errors while tracking exclude a kidnap, and errors until the recovery contain all of it") {
  BendingDrive drive;
  drive.kidnap(120);
  drive.say(102, 120, TrackingState::kRecovering);
  const SplitErrors split = drive.split();
  REQUIRE(split.tracking);
  CHECK(split.tracking->poses == 180);
  CHECK(split.tracking->ate_m.rmse == doctest::Approx(0.1));
  CHECK(split.tracking->ate_m.max == doctest::Approx(0.1));
  REQUIRE(split.away.size() == 1);
  CHECK(split.away[0].poses == 20);  // the first two report TRACKING at a wrong pose
  REQUIRE(split.away[0].ate_m);
  CHECK(split.away[0].ate_m->rmse == doctest::Approx(8).epsilon(0.02));
}

TEST_CASE("relative errors while tracking do not span a kidnap") {
  BendingDrive drive;
  drive.kidnap(120);
  const SplitErrors split = drive.split();
  REQUIRE(split.tracking);
  REQUIRE(split.tracking->rpe[1]);
  CHECK(split.tracking->rpe[1]->percent < 2.1);  // 0.2 m of 10 m
  CHECK(relative_error(match_by_time(drive.estimate, drive.truth), 10)->percent > 4);
}

TEST_CASE("without a recovery, all poses after a kidnap are excluded from tracking") {
  BendingDrive drive;
  drive.kidnap(1000);
  const SplitErrors split = drive.split();
  REQUIRE(split.tracking);
  CHECK(split.tracking->poses == 100);
  CHECK(split.away[0].poses == 100);
}

TEST_CASE("LOST and INITIALISING poses are left out, DEGRADED ones count; without states all poses count") {
  BendingDrive drive;
  drive.say(0, 1, TrackingState::kInitialising);
  drive.say(50, 60, TrackingState::kDegraded);
  drive.say(70, 90, TrackingState::kLost);
  for (int i = 70; i < 90; ++i) drive.estimate[i].pose.translation().x() += 5;
  CHECK(drive.split().tracking->poses == 179);
  CHECK(drive.split().tracking->ate_m.max == doctest::Approx(0.1));
  CHECK(drive.split().away.empty());
  drive.states.clear();
  CHECK(drive.split().tracking->poses == 200);
  CHECK(drive.split().tracking->ate_m.max > 4.9);
}

TEST_CASE("an overlay with too few tracked poses gives no error while tracking") {
  BendingDrive drive;
  drive.say(0, 198, TrackingState::kLost);
  const PosePairs pairs = match_by_time(drive.estimate, drive.truth);
  CHECK_FALSE(split_errors(pairs, drive.states, {}, Overlay::kSe3).tracking);
  CHECK(split_errors(pairs, drive.states, {}, Overlay::kYaw).tracking);
}
