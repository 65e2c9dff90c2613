// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/drive.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/rigid.hpp"
#include "simulation/world.hpp"

using namespace scanlock;

namespace {

Drive drive_of(const World& world, double seconds, const std::vector<SimulationEvent>& events = {}) {
  return Drive(world.route, world.scene.terrain(), world.style, events, seconds, 3);
}

}  // namespace

TEST_CASE("drive - the twist is the derivative of the pose") {
  const World world = make_world(WorldKind::kIndoor, 3, {30});
  const Drive drive = drive_of(world, 30, {parse_event("shake@10+2")});
  const PoseSpline& motion = drive.piece(0);
  for (double t = 0.013; t < 30; t += 0.0871) {
    constexpr double kStep = 1e-4;
    const Vector6 difference =
        se3_log(motion.pose(t - kStep).inverse() * motion.pose(t + kStep)) / (2 * kStep);
    CHECK((difference - motion.twist(t)).norm() < 1e-4);
  }
}

TEST_CASE("drive - velocity and acceleration are continuous and bounded, turns are as fast as promised") {
  struct Expectation {
    WorldKind kind;
    double fastest, fastest_turn, acceleration;  // m/s, rad/s, m/s^2
  };
  for (const Expectation& expected : {Expectation{WorldKind::kUrban, 14.3, 45 * kDegree, 6.0},
                                      {WorldKind::kIndoor, 1.4, 125 * kDegree, 4.0},
                                      {WorldKind::kForest, 2.3, 60 * kDegree, 8.0},
                                      {WorldKind::kTunnel, 18.3, 20 * kDegree, 6.0},
                                      {WorldKind::kField, 4.6, 40 * kDegree, 6.0}}) {
    const World world = make_world(expected.kind, 4, {120});
    const Drive drive = drive_of(world, 120);
    const PoseSpline& motion = drive.piece(0);
    double fastest = 0, fastest_turn = 0, acceleration = 0, jump = 0;
    constexpr double kStep = 0.002;
    for (double t = 0; t < 120; t += kStep) {
      fastest = std::max(fastest, motion.twist(t).head<2>().norm());
      fastest_turn = std::max(fastest_turn, std::abs(motion.twist(t)[5]));
      acceleration = std::max(acceleration, motion.acceleration(t).norm());
      jump = std::max(jump, (motion.acceleration(t + kStep) - motion.acceleration(t)).norm());
    }
    CAPTURE(static_cast<int>(expected.kind));
    CHECK(fastest < expected.fastest);
    CHECK(fastest > 0.6 * expected.fastest);
    CHECK(fastest_turn < expected.fastest_turn);
    CHECK(acceleration < expected.acceleration);
    CHECK(jump < 0.1 * expected.acceleration);
  }
}

TEST_CASE("drive - a start in motion has its speed at once, and brakes to the usual speed as a vehicle can") {
  for (const WorldKind kind : {WorldKind::kUrban, WorldKind::kForest}) {
    for (const double start : {2.0, 15.0, 30.0}) {
      const World world = make_world(kind, 4, {30, 0, 0, start});
      const Drive drive = drive_of(world, 30);
      const PoseSpline& motion = drive.piece(0);
      CAPTURE(start);
      const auto speed = [&](double t) { return motion.twist(t).head<2>().norm(); };
      CHECK(std::abs(speed(0) - start) < 0.05 * start + 0.2);
      CHECK(std::abs(speed(0.1) - start) < 0.05 * start + 0.3);
      double hardest = 0;  // m/s^2
      for (double t = 0; t < 29; t += 0.1) hardest = std::max(hardest, (speed(t) - speed(t + 0.5)) / 0.5);
      CHECK(hardest < 8);  // cutting corners makes the path shorter than the route
      CHECK(speed(29) < std::max(start - 20 * world.style.brake, world.style.fast_mps + 1));
    }
  }
}

TEST_CASE("drive - indoors some turns exceed 90 degrees a second, in town some exceed 20") {
  for (const auto& [kind, rate] : {std::pair{WorldKind::kIndoor, 90.0}, std::pair{WorldKind::kUrban, 20.0}}) {
    const World world = make_world(kind, 4, {120});
    const Drive drive = drive_of(world, 120);
    double fastest = 0;
    for (double t = 0; t < 120; t += 0.02) fastest = std::max(fastest, std::abs(drive.piece(0).twist(t)[5]));
    CHECK(fastest > rate * kDegree);
  }
}

TEST_CASE("drive - shaking turns the sensor fast, and only while it lasts") {
  const World world = make_world(WorldKind::kUrban, 4, {20});
  const Drive calm = drive_of(world, 20), shaken = drive_of(world, 20, {parse_event("shake@10+3")});
  double before = 0, during = 0;
  for (double t = 0; t < 9.8; t += 0.01)
    before = std::max(before, (calm.piece(0).twist(t) - shaken.piece(0).twist(t)).norm());
  for (double t = 10; t < 13; t += 0.01) during = std::max(during, shaken.piece(0).twist(t).tail<3>().norm());
  CHECK(before < 1e-12);
  CHECK(during > 90 * kDegree);
  CHECK(during < 300 * kDegree);
}

TEST_CASE("drive - a kidnap carries the sensor 3 to 15 m onto ground already driven") {
  const World world = make_world(WorldKind::kUrban, 4, {40});
  const Drive drive = drive_of(world, 40, {parse_event("kidnap@20"), parse_event("kidnap@30")});
  REQUIRE(drive.pieces() == 3);
  CHECK(drive.piece_at(19.99) == 0);
  CHECK(drive.piece_at(20) == 1);
  for (const auto& [before, t] : {std::pair<std::size_t, double>{0, 20}, {1, 30}}) {
    const Eigen::Vector3d from = drive.piece(before).pose(t).translation();
    const Eigen::Vector3d to = drive.piece(before + 1).pose(t).translation();
    CHECK((to - from).norm() > 2.8);
    CHECK((to - from).norm() < 15.2);
    double nearest = HUGE_VAL;  // distance to earlier positions
    for (double past = 0; past < t; past += 0.01)
      nearest = std::min(nearest, (drive.piece(0).pose(past).translation() - to).norm());
    CHECK(nearest < 0.3);
  }
}

TEST_CASE("drive - a kidnap before 3 m are driven is refused") {
  const World world = make_world(WorldKind::kUrban, 4, {20});
  CHECK_THROWS_AS(drive_of(world, 20, {parse_event("kidnap@0.5")}), std::invalid_argument);
}

TEST_CASE("event - texts are parsed to kinds and times") {
  const SimulationEvent event = parse_event("blackout@12.5+3");
  CHECK(event.kind == EventKind::kBlackout);
  CHECK(event.time_s == 12.5);
  CHECK(event.duration_s == 3);
  CHECK(event.active(12.5));
  CHECK_FALSE(event.active(15.5));
  for (const char* wrong : {"", "kidnap", "kidnap@", "kidnap@x", "kidnap@3+1", "shake@3", "shake@3+",
                            "shake@3+0", "shake@-3+1", "fly@3", "dropout@1+nan", "dropout@1+2x"})
    CHECK_THROWS_AS(parse_event(wrong), std::invalid_argument);
}
