// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/kidnaps.hpp"

#include <doctest/doctest.h>

using namespace scanlock;

namespace {

Pose exp6(double x, double y, double z, double rx, double ry, double rz) {
  Vector6 xi;
  xi << x, y, z, rx, ry, rz;
  return se3_exp(xi);
}

const Pose kElsewhere = exp6(30, -20, 2, 0.02, -0.01, 2.0);  // the frame of the estimate in that of the truth
constexpr double kTruthStart = 1.6e9;

/// A truth at 10 Hz and 30 m/s along a bend, kidnapped by 8 m and 120 degrees at 5 s; 15 s long.
struct KidnappedDrive {
  Trajectory truth, estimate;
  std::vector<StampedState> states;
  PosePairs pairs() const { return match_by_time(estimate, truth); }
};

/// The estimate goes on as if there were no kidnap until `back` seconds after it; its state shows the loss
/// from 0.2 s on.
KidnappedDrive kidnapped_drive(double back, const Pose& where_to = Pose::Identity()) {
  KidnappedDrive drive;
  Pose truth = exp6(5, 5, 0, 0, 0, 0.3), believed = truth;
  for (int i = 0; i < 150; ++i) {
    const double since = 0.1 * (i - 50);
    if (i > 0) {
      truth = truth * exp6(3, 0, 0, 0, 0, 0.03);
      believed = believed * exp6(3, 0, 0, 0, 0, 0.03);
    }
    if (i == 50) truth = truth * exp6(8, 0, 0, 0, 0, 2.1);
    const bool home = i < 50 || since > back - 1e-6;
    TrackingState state = home || since < 0.15 ? TrackingState::kTracking : TrackingState::kLost;
    if (i == 0) state = TrackingState::kInitialising;
    const double time = kTruthStart + 0.1 * i;
    drive.truth.push_back({time, truth});
    const Pose estimate = i < 50 ? truth : home ? truth * where_to : believed;
    drive.estimate.push_back({time, kElsewhere.inverse() * estimate});
    drive.states.push_back({time, state});
  }
  return drive;
}

KidnapReport examine(const KidnappedDrive& drive) {
  return examine_kidnaps(drive.truth, drive.pairs(), drive.states, Overlay::kSe3);
}

}  // namespace

TEST_CASE("a fast drive with bends and missing poses contains no kidnap") {
  Trajectory truth;
  Pose pose = Pose::Identity();
  for (int i = 0; i < 300; ++i) {
    pose = pose * exp6(4, 0, 0, 0, 0, i < 100 ? 0.0 : 0.03);
    if (i % 50 > 3) truth.push_back({0.1 * i, pose});  // four poses in a row are missing
  }
  CHECK(find_kidnaps(truth).empty());
  CHECK(find_kidnaps({}).empty());
}

TEST_CASE("a kidnap is detected by a jump of the position or by a jump of the attitude") {
  const auto kidnaps = find_kidnaps(kidnapped_drive(1).truth);
  REQUIRE(kidnaps.size() == 1);
  CHECK(kidnaps[0].index == 50);
  CHECK(kidnaps[0].time_s == doctest::Approx(kTruthStart + 5));
  CHECK(kidnaps[0].jump_deg == doctest::Approx(2.1 * 57.29578).epsilon(0.01));
  Trajectory turned;
  for (int i = 0; i < 20; ++i) turned.push_back({0.1 * i, exp6(0, 0, 0, 0, 0, i < 10 ? 0.0 : 3.0)});
  CHECK(find_kidnaps(turned).size() == 1);
}

TEST_CASE("a robot that is turned round and driven backwards counts as one kidnap") {
  Trajectory truth;
  Pose pose = Pose::Identity();
  for (int i = 0; i < 100; ++i) {
    pose = pose * exp6(i < 50 ? 0.9 : -0.9, 0, 0, 0, 0, 0.01);
    if (i == 50) pose = pose * exp6(0, 5, 0, 0, 0, 3.1);
    truth.push_back({0.1 * i, pose});
  }
  CHECK(find_kidnaps(truth).size() == 1);
}

TEST_CASE("the recovery time lasts until the estimate is right and stays right") {
  const KidnapReport report = examine(kidnapped_drive(1.3));
  REQUIRE(report.kidnaps.size() == 1);
  REQUIRE(report.kidnaps[0].recovery_s);
  CHECK(*report.kidnaps[0].recovery_s == doctest::Approx(1.3).epsilon(1e-3));
  CHECK(report.wrong_jumps == 0);
  CHECK(report.reference_from_estimate.isApprox(kElsewhere, 1e-9));
}

TEST_CASE("without a recovery there is no recovery time") {
  const KidnapReport report = examine(kidnapped_drive(100));
  REQUIRE(report.kidnaps.size() == 1);
  CHECK_FALSE(report.kidnaps[0].recovery_s);
  CHECK(report.wrong_jumps == 0);
}

TEST_CASE("a right pose that is lost again does not end the recovery time") {
  KidnappedDrive drive = kidnapped_drive(1.3);
  for (int i = 66; i < 80; ++i) drive.states[static_cast<std::size_t>(i)].state = TrackingState::kLost;
  const KidnapReport report = examine(drive);
  REQUIRE(report.kidnaps[0].recovery_s);
  CHECK(*report.kidnaps[0].recovery_s == doctest::Approx(3.0).epsilon(1e-3));
}

TEST_CASE("TRACKING at a wrong pose after a kidnap is one wrong jump") {
  const KidnapReport report = examine(kidnapped_drive(1.3, exp6(0, 12, 0, 0, 0, 0)));
  CHECK(report.wrong_jumps == 1);
  CHECK_FALSE(report.kidnaps[0].recovery_s);
}

TEST_CASE("TRACKING in a new map is no wrong jump, unless the epoch is the old one or the pose jumps") {
  const auto drive_on = [](std::uint32_t epoch, double jump_m) {
    KidnappedDrive drive = kidnapped_drive(100);
    for (std::size_t i = 100; i < drive.states.size(); ++i) {
      drive.states[i].state = TrackingState::kTracking;
      drive.states[i].epoch = epoch;
      drive.estimate[i].pose = drive.estimate[i].pose * exp6(0, jump_m, 0, 0, 0, 0);
    }
    return *examine(drive).wrong_jumps;
  };
  CHECK(drive_on(1, 0) == 0);
  CHECK(drive_on(0, 0) == 1);
  CHECK(drive_on(1, 10) == 1);
}

TEST_CASE("TRACKING through a kidnap is one wrong jump") {
  KidnappedDrive drive = kidnapped_drive(100);
  for (StampedState& state : drive.states) state.state = TrackingState::kTracking;
  CHECK(examine(drive).wrong_jumps == 1);
}

TEST_CASE("TRACKING after two DEGRADED poses at a kidnap is one wrong jump") {
  KidnappedDrive drive = kidnapped_drive(100);
  for (std::size_t i = 0; i < drive.states.size(); ++i)
    drive.states[i].state = i == 50 || i == 51 ? TrackingState::kDegraded : TrackingState::kTracking;
  CHECK(examine(drive).wrong_jumps == 1);
}

TEST_CASE("drift in DEGRADED poses before a kidnap is no wrong jump and does not change the recovery time") {
  KidnappedDrive drive = kidnapped_drive(1.0);
  for (std::size_t i = 20; i < 50; ++i) {
    drive.states[i].state = TrackingState::kDegraded;
    drive.estimate[i].pose.translation().x() += static_cast<double>(i - 20);
  }
  const KidnapReport report = examine(drive);
  CHECK(report.wrong_jumps == 0);
  REQUIRE(report.kidnaps.size() == 1);
  REQUIRE(report.kidnaps[0].recovery_s);
  CHECK(*report.kidnaps[0].recovery_s == doctest::Approx(1.0).epsilon(1e-3));
}

TEST_CASE("a wrong pose after a second INITIALISING state is a wrong jump") {
  KidnappedDrive drive = kidnapped_drive(1);
  for (std::size_t i = 30; i < 40; ++i)
    drive.estimate[i].pose = drive.estimate[i].pose * exp6(0, 5, 0, 0, 0, 0);
  drive.states[30].state = TrackingState::kInitialising;
  CHECK(examine(drive).wrong_jumps == 1);
}

TEST_CASE("drift from the start of the drive is no wrong jump, but the same poses after LOST are one") {
  KidnappedDrive drive = kidnapped_drive(1);
  for (std::size_t i = 0; i < 20; ++i)  // 4 m in two seconds
    drive.estimate[i].pose =
        drive.estimate[i].pose * exp6(0, 0.2 * (20 - static_cast<double>(i)), 0, 0, 0, 0);
  CHECK(examine(drive).wrong_jumps == 0);
  drive.states[0].state = TrackingState::kLost;  // lost, and then found at a wrong pose
  CHECK(examine(drive).wrong_jumps == 1);
}

TEST_CASE("drift is no wrong jump, and without states the number of wrong jumps is unknown") {
  KidnappedDrive drive = kidnapped_drive(1.3);
  for (std::size_t i = 80; i < 150; ++i)
    drive.estimate[i].pose.translation().z() += 0.1 * static_cast<double>(i - 80);
  CHECK(examine(drive).wrong_jumps == 0);
  drive.states.clear();
  const KidnapReport report = examine(drive);
  CHECK_FALSE(report.wrong_jumps);
  CHECK(*report.kidnaps[0].recovery_s == doctest::Approx(1.3).epsilon(1e-3));
}
