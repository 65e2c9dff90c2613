// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/consistency_check.hpp"

#include <doctest/doctest.h>

using namespace scanlock;

namespace {

Pose exp6(double x, double y, double z, double rx, double ry, double rz) {
  Vector6 xi;
  xi << x, y, z, rx, ry, rz;
  return se3_exp(xi);
}

const Pose kMount = exp6(1.2, 0.3, 0.9, 0.2, -0.1, 1.5);
const Pose kStep = exp6(0.8, 0, 0.01, 0.003, 0.01, 0.05);     // motion of the body from scan to scan
const Pose kBodyAtFirst = exp6(50, -20, 1, 0.02, 0.04, 2.5);  // pose of the body in the frame of its odometry

Pose body_at(int scan) {
  Pose pose = kBodyAtFirst;
  for (int i = 0; i < scan; ++i) pose = pose * kStep;
  return pose;
}

PriorSample sample_at(int scan) {
  return {body_at(scan), Eigen::Quaterniond(body_at(scan).linear())};
}

/// The tracker's report for the sensor on that body; the map's frame is that of the sensor at the first scan.
TrackedScan tracked_at(int scan) {
  TrackedScan tracked;
  tracked.utime = 100000 * scan;
  tracked.state = TrackingState::kTracking;
  tracked.method = PoseMethod::kIcp;
  tracked.map_from_body = (kBodyAtFirst * kMount).inverse() * body_at(scan) * kMount;
  return tracked;
}

}  // namespace

TEST_CASE("motion and attitude are turned from the body to the sensor") {
  ConsistencyCheck judge(kMount);
  CHECK_FALSE(judge.prior(sample_at(0)).motion);  // there is no scan before
  judge.learn(sample_at(0), tracked_at(0));
  const ScanPrior prior = judge.prior(sample_at(1));
  REQUIRE(prior.motion);
  const Pose seen = tracked_at(0).map_from_body.inverse() * tracked_at(1).map_from_body;
  CHECK(prior.motion->isApprox(seen, 1e-9));
  REQUIRE(prior.level_from_body);
  CHECK(prior.level_from_body->toRotationMatrix().isApprox((body_at(1) * kMount).linear(), 1e-9));
}

TEST_CASE("priors that agree are never reported as contradicting") {
  ConsistencyCheck judge(kMount);
  for (int i = 0; i < 200; ++i) CHECK_FALSE(judge.learn(sample_at(i), tracked_at(i)));
  CHECK(judge.contradictions() == 0);
}

TEST_CASE("odometry that contradicts the scans is withheld, and used again when it agrees") {
  ConsistencyCheck judge(kMount);
  judge.learn(sample_at(0), tracked_at(0));
  int withheld_at = -1;
  Pose wrong = body_at(0);
  for (int i = 1; i < 12; ++i) {  // the wheel odometry reports three times the path
    wrong = wrong * kStep * kStep * kStep;
    const auto sentence = judge.learn({wrong, std::nullopt}, tracked_at(i));
    if (sentence && withheld_at < 0) {
      withheld_at = i;
      CHECK(sentence->find("odometry prior contradicts the scans") != std::string::npos);
    }
  }
  CHECK(withheld_at == 5);
  CHECK_FALSE(judge.prior({wrong * kStep, std::nullopt}).motion);
  int back_at = -1;
  for (int i = 12; i < 40 && back_at < 0; ++i) {
    if (judge.learn(sample_at(i), tracked_at(i))) back_at = i;
  }
  CHECK(back_at > 12);
  CHECK(judge.prior(sample_at(back_at + 1)).motion);
}

TEST_CASE("single slips do not withhold odometry") {
  ConsistencyCheck judge(kMount);
  Pose slipped = Pose::Identity();
  for (int i = 0; i < 30; ++i) {
    if (i % 10 == 9) slipped = slipped * exp6(0.5, 0, 0, 0, 0, 0);
    CHECK_FALSE(judge.learn({body_at(i) * slipped, std::nullopt}, tracked_at(i)));
  }
  CHECK(judge.trusts_odometry());
  CHECK(judge.contradictions() == 3);
}

TEST_CASE("an attitude that tilts away from the scans is withheld") {
  ConsistencyCheck judge(kMount);
  for (int i = 0; i < 30; ++i) judge.learn(sample_at(i), tracked_at(i));
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()));
  for (int i = 30; i < 36; ++i) {
    PriorSample sample = sample_at(i);
    sample.level_from_body = tilt * *sample.level_from_body;
    judge.learn(sample, tracked_at(i));
  }
  CHECK_FALSE(judge.trusts_attitude());
  CHECK(judge.trusts_odometry());
  CHECK_FALSE(judge.prior(sample_at(36)).level_from_body);
}

TEST_CASE("scans of a tracker that is lost or jumps do not contradict the odometry") {
  ConsistencyCheck judge(kMount);
  for (int i = 0; i < 30; ++i) {
    TrackedScan tracked = tracked_at(i);
    tracked.map_from_body.translation().x() += 5 * i;
    if (i % 2 == 0) {
      tracked.state = TrackingState::kLost;
      tracked.method = PoseMethod::kPredicted;
    }
    tracked.epoch = static_cast<std::uint32_t>(i / 2);
    judge.learn(sample_at(i), tracked);
  }
  CHECK(judge.contradictions() == 0);
}
