// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/nees.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "../io/temporary_directory.hpp"
#include "geometry/linear.hpp"
#include "io/lcm_log.hpp"
#include "messages/encode.hpp"

using namespace scanlock;

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity(), kStart = 1.6e9;
constexpr std::uint32_t kPlane = 0b011100;

Vector6 vector6(double x, double y, double z, double rx, double ry, double rz) {
  Vector6 v;
  v << x, y, z, rx, ry, rz;
  return v;
}

/// A covariance L L^T with correlations, with decimetres in translation and milliradians in rotation.
Matrix6 some_covariance() {
  Matrix6 root = Matrix6::Zero();
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column <= row; ++column)
      root(row, column) = (row < 3 ? 0.1 : 1e-3) * (row == column ? 1.5 : 0.4 * std::cos(row + 3 * column));
  return root * root.transpose();
}

/// A drive along a bend with 1 m per pose, with different frames for the true poses and the estimate.
struct Drive {
  PosePairs pairs;
  std::vector<StampedState> states;
};

/// `error(k)`: the error of pose k by the covariance's convention: estimate = true pose in the map frame *
/// exp(error).
template <typename Error>
Drive drive_of(int poses, const Error& error) {
  const Pose truth_start = se3_exp(vector6(40, -7, 2, 0.03, -0.02, 2));
  const Pose map_start = se3_exp(vector6(1, 0, 0, 0.01, 0.02, 0.5));
  Drive drive;
  Pose moved = Pose::Identity();
  for (int k = 0; k < poses; ++k) {
    if (k > 0) moved = moved * se3_exp(vector6(1, 0, 0, 0.002, 0, 0.01));
    const double time = kStart + 0.1 * k;
    StampedState state;
    state.time_s = time;
    state.state = k == 0 ? TrackingState::kInitialising : TrackingState::kTracking;
    state.map_from_body = map_start * moved * se3_exp(k == 0 ? Vector6(Vector6::Zero()) : Vector6(error(k)));
    state.covariance = some_covariance();
    drive.states.push_back(state);
    drive.pairs.push_back({time, 1.0 * k, state.map_from_body, truth_start * moved});
  }
  return drive;
}

/// An error with this squared Mahalanobis norm under some_covariance().
Vector6 error_of(double square, int axis = 3) {
  const Matrix6 root = cholesky(some_covariance());
  return root * std::sqrt(square) * Vector6::Unit(axis);
}

}  // namespace

TEST_CASE("NEES of a known error in a known covariance, in frames that differ") {
  for (const double square : {0.0, 6.0, 16.0, 17.0, 400.0})
    for (const int axis : {0, 3, 5}) {
      const Drive drive = drive_of(101, [&](int) { return error_of(square, axis); });
      const auto nees = normalised_error(drive.pairs, drive.states, kNever);
      REQUIRE(nees);
      CHECK(nees->poses == 20);  // every 5 m
      CHECK(nees->dof == 6);
      CHECK(nees->mean == doctest::Approx(square).epsilon(1e-6));
      CHECK(nees->beyond_99 == doctest::Approx(square > 16.81 ? 1 : 0));
    }
}

TEST_CASE("NEES is taken every 5 m, and every 50 m on paths of more than 200 m") {
  const auto marked = [](int every) { return [every](int k) { return error_of(k % every == 0 ? 20 : 1); }; };
  const Drive at_200 = drive_of(201, marked(50)), at_500 = drive_of(501, marked(100));
  const auto short_way = normalised_error(at_200.pairs, at_200.states, kNever);
  REQUIRE(short_way);
  CHECK(short_way->poses == 40);
  CHECK(short_way->beyond_99 == doctest::Approx(0.1));
  const auto long_way = normalised_error(at_500.pairs, at_500.states, kNever);
  REQUIRE(long_way);
  CHECK(long_way->poses == 10);
  CHECK(long_way->beyond_99 == doctest::Approx(0.5));
  CHECK(long_way->mean == doctest::Approx(10.5));
}

TEST_CASE("NEES skips poses that do not track, and takes the next pose that does") {
  Drive drive = drive_of(31, [](int k) { return error_of(k); });
  drive.states[5].state = TrackingState::kRecovering;
  drive.states[6].state = TrackingState::kDegraded;
  drive.states[15].covariance.setZero();  // no covariance
  // A state that was not recorded.
  drive.states.erase(drive.states.begin() + 20);
  for (int k = 24; k < 30; ++k) drive.states[k].state = TrackingState::kLost;  // poses 25 to 30
  const auto nees = normalised_error(drive.pairs, drive.states, kNever);
  REQUIRE(nees);
  CHECK(nees->poses == 4);
  CHECK(nees->mean == doctest::Approx((6 + 10 + 16 + 21) / 4.0));
}

TEST_CASE("NEES ends at the first kidnap and at the first change of epoch") {
  Drive drive = drive_of(101, [](int k) { return error_of(k < 50 ? 4 : 1000); });
  CHECK(normalised_error(drive.pairs, drive.states, kNever)->mean > 500);
  const auto before = normalised_error(drive.pairs, drive.states, kStart + 5);
  REQUIRE(before);
  CHECK(before->poses == 9);
  CHECK(before->mean == doctest::Approx(4));
  for (int k = 50; k < 80; ++k) drive.states[k].epoch = 1;  // poses after 80 m are not used either
  CHECK(normalised_error(drive.pairs, drive.states, kNever)->poses == 9);
}

TEST_CASE("NEES of a planar sensor is that of x, y and yaw") {
  Drive drive = drive_of(51, [](int) { return vector6(0.2, 0, 5, 1e-8, 0, 0.03); });
  Matrix6 covariance = Matrix6::Identity();
  covariance.diagonal() << 0.01, 0.01, 1e-12, 1e-12, 1e-12, 1e-4;
  covariance(0, 1) = covariance(1, 0) = 0.006;
  for (StampedState& state : drive.states) {
    state.degenerate_axes = kPlane | 1;
    state.covariance = covariance;
  }
  const auto nees = normalised_error(drive.pairs, drive.states, kNever);
  REQUIRE(nees);
  CHECK(nees->dof == 3);
  CHECK(nees->poses == 10);
  // By hand: the inverse of ((1, 0.6), (0.6, 1)) / 100 has 100 / 0.64 in its corner. The translation of the
  // error's logarithm is as given; 0.04 * 156.25 + 9e-4 * 1e4.
  CHECK(nees->mean == doctest::Approx(6.25 + 9).epsilon(1e-6));
  CHECK(nees->beyond_99 == doctest::Approx(1));  // beyond 11.34 (3 degrees of freedom), not beyond 16.81 (6)
  drive.states[25].degenerate_axes = 1;
  CHECK(normalised_error(drive.pairs, drive.states, kNever)->dof == 6);
}

TEST_CASE("NEES of errors drawn from the covariance is 6, and one percent is beyond the bound") {
  std::mt19937_64 rng(7);
  std::normal_distribution<double> normal;
  const Matrix6 root = cholesky(some_covariance());
  double mean = 0, beyond = 0;
  constexpr int kDrives = 100;
  for (int i = 0; i < kDrives; ++i) {
    const Drive drive = drive_of(201, [&](int) {
      Vector6 z;
      for (int axis = 0; axis < 6; ++axis) z[axis] = normal(rng);
      return Vector6(root * z);
    });
    const auto nees = normalised_error(drive.pairs, drive.states, kNever);
    REQUIRE(nees);
    mean += nees->mean / kDrives;
    beyond += nees->beyond_99 / kDrives;
  }
  CHECK(mean == doctest::Approx(6).epsilon(0.03));  // 4000 values: standard deviation 0.055
  CHECK(beyond > 0.005);
  CHECK(beyond < 0.015);
}

TEST_CASE("NEES of a log is that of the poses and covariances in its scanlock.odometry_t") {
  TemporaryDirectory directory;
  const Drive drive = drive_of(51, [](int) { return error_of(7); });
  LogWriter log(directory / "poses.lcmlog");
  for (const StampedState& state : drive.states) {
    TrackedScan tracked;
    tracked.utime = std::llround(state.time_s * 1e6);
    tracked.state = state.state;
    tracked.map_from_body = state.map_from_body;
    tracked.covariance = state.covariance;
    tracked.degenerate_axes = 5;
    log.write(tracked.utime, kDefaultOdometryChannel, encode_odometry(tracked, {}));
  }
  log.close();
  const std::vector<StampedState> states = load_states(directory / "poses.lcmlog");
  REQUIRE(states.size() == 51);
  CHECK(states[20].degenerate_axes == 5);
  const auto nees = normalised_error(drive.pairs, states, kNever);
  REQUIRE(nees);
  CHECK(nees->poses == 10);
  CHECK(nees->mean == doctest::Approx(7).epsilon(1e-6));
}

TEST_CASE("NEES is unknown without covariances, and infinite with an invalid covariance") {
  Drive drive = drive_of(51, [](int) { return error_of(1); });
  CHECK_FALSE(normalised_error(drive.pairs, {}, kNever));
  CHECK_FALSE(normalised_error({}, drive.states, kNever));
  CHECK_FALSE(
      normalised_error(PosePairs(drive.pairs.begin(), drive.pairs.begin() + 4), drive.states, kNever));
  drive.states[10].covariance(0, 1) = drive.states[10].covariance(1, 0) = 1e3;
  const auto nees = normalised_error(drive.pairs, drive.states, kNever);
  REQUIRE(nees);
  CHECK(nees->mean == std::numeric_limits<double>::infinity());
  CHECK(nees->beyond_99 == doctest::Approx(0.1));
  for (StampedState& state : drive.states) state.covariance.setZero();
  CHECK_FALSE(normalised_error(drive.pairs, drive.states, kNever));
}
