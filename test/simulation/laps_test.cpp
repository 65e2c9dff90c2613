// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/laps.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "simulation/simulator.hpp"

using namespace scanlock;

namespace {

constexpr WorldKind kLooped[] = {WorldKind::kIndoor, WorldKind::kUrban, WorldKind::kForest,
                                 WorldKind::kField};

SimulationConfig laps_of(WorldKind world, int laps, std::uint64_t seed = 5) {
  SimulationConfig config;
  config.world = world;
  config.lidar = LidarKind::kPlanar;
  config.laps = laps;
  config.seed = seed;
  return config;
}

/// The smallest distance of a pose to the poses of the drive from `from` to `to` (seconds), and the
/// difference of headings there.
struct Meeting {
  double distance = HUGE_VAL, turned = 0;
};
Meeting nearest(const Drive& drive, const Pose& pose, double from, double to) {
  Meeting best;
  for (double t = from; t < to; t += 0.05) {
    const Pose other = drive.piece(0).pose(t);
    const double distance = (other.translation() - pose.translation()).head<2>().norm();
    if (distance >= best.distance) continue;
    best.distance = distance;
    best.turned = so3_log(other.linear().transpose() * pose.linear()).norm();
  }
  return best;
}

/// The time, seconds, at which the drive has covered a distance.
double time_at(const Simulator& simulator, double distance_m) {
  double t = 0;
  while (t < simulator.seconds() && simulator.drive().distance(t) < distance_m) t += 0.05;
  return t;
}

bool sees(const Scene& scene, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const double apart = (to - from).norm();
  if (apart > 100) return false;  // beyond most sensors' range
  if (apart < 0.5) return true;
  const Hit hit = scene.cast({from, (to - from) / apart}, apart, 1);
  return !hit.found;
}

/// Whether an upright body of this radius, from 0.3 m to 1 m above the floor, intersects a box or a cylinder.
bool collides(const Scene& scene, const Eigen::Vector3d& sensor, double ground, double radius) {
  const auto within = [&](double low, double high) { return low < ground + 1 && high > ground + 0.3; };
  for (const Box& box : scene.boxes()) {
    const Bounds bounds = bounds_of(box);
    if (!within(bounds.min().z(), bounds.max().z())) continue;
    const Eigen::Vector2d inside = (box.world_from_box.transpose() * (sensor - box.centre)).head<2>();
    const Eigen::Vector2d outside = (inside.cwiseAbs() - box.half.head<2>()).cwiseMax(0);
    if (outside.norm() < radius) return true;
  }
  for (const Cylinder& cylinder : scene.cylinders())
    if (within(cylinder.base.z(), cylinder.base.z() + cylinder.length) &&
        (cylinder.base - sensor).head<2>().norm() < cylinder.radius + radius)
      return true;
  return false;
}

}  // namespace

TEST_CASE("laps - a closed lap has no corner, nor one where it closes") {
  const Polyline lap = closed_lap({{0, 0}, {20, 0}, {20, 10}, {0, 10}}, 0.05, 1.4);
  CHECK((lap.points().front() - lap.points().back()).norm() == 0);
  CHECK(lap.length() == doctest::Approx(60).epsilon(0.04));
  Random random(1);
  World world;
  world.style = style_of(WorldKind::kIndoor);
  set_laps(world, lap, 2, {0, 5}, random);
  CHECK(world.laps_end_m == doctest::Approx(2 * lap.length() + kBeyondLap).epsilon(1e-3));
  CHECK(world.route.length() > world.laps_end_m + 25);  // room for the car ahead of the robot
  double tightest = 0;
  for (double s = 0; s < world.route.length(); s += 0.05)
    tightest = std::max(tightest, std::abs(world.route.curvature(s)));
  CHECK(tightest < 1 / 0.5);
  CHECK(world.route.heading(lap.length() + 5) - world.route.heading(5) == doctest::Approx(2 * M_PI));
}

TEST_CASE("laps - the drive comes by each place once a lap, in the same direction but not on the same line") {
  for (const WorldKind kind : kLooped) {
    CAPTURE(static_cast<int>(kind));
    const Simulator simulator(laps_of(kind, 2));
    const World& world = simulator.world();
    const Drive& drive = simulator.drive();
    CHECK(drive.distance(simulator.seconds()) == doctest::Approx(2 * world.lap_m + kBeyondLap).epsilon(0.02));
    const double first_lap = time_at(simulator, 0.99 * world.lap_m);
    double mean = 0, farthest = 0, turned = 0;
    constexpr int kPlaces = 40;
    for (int i = 1; i <= kPlaces; ++i) {
      const double t = time_at(simulator, world.lap_m * (1 + 0.95 * i / kPlaces));
      const Meeting meeting = nearest(drive, drive.piece(0).pose(t), 0, first_lap);
      mean += meeting.distance / kPlaces;
      farthest = std::max(farthest, meeting.distance);
      turned = std::max(turned, meeting.turned);
    }
    CHECK(mean > 0.05);
    CHECK(farthest < 2);
    CHECK(turned < 45 * kDegree);
    const double end = nearest(drive, drive.piece(0).pose(simulator.seconds()), 0, first_lap / 4).distance;
    CHECK(end < 2);
  }
}

TEST_CASE("laps - the lap length is within its range for every seed, without collisions") {
  struct Expectation {
    WorldKind kind;
    double shortest, longest, radius;  // metres
  };
  for (const Expectation& expected : {Expectation{WorldKind::kIndoor, 240, 260, 0.25},
                                      {WorldKind::kUrban, 540, 660, 0.9},
                                      {WorldKind::kForest, 320, 340, 0.3},
                                      {WorldKind::kField, 430, 450, 1}})
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      CAPTURE(static_cast<int>(expected.kind));
      CAPTURE(seed);
      const Simulator simulator(laps_of(expected.kind, 2, seed));
      CHECK(simulator.world().lap_m > expected.shortest);
      CHECK(simulator.world().lap_m < expected.longest);
      const Scene& scene = simulator.world().scene;
      int collisions = 0;
      const double step = simulator.seconds() / 400;
      for (double t = 0; t < simulator.seconds(); t += step) {
        const Eigen::Vector3d p = simulator.drive().piece(0).pose(t).translation();
        if (collides(scene, p, scene.terrain().height(p.x(), p.y()), expected.radius)) ++collisions;
      }
      CHECK(collisions == 0);
    }
}

TEST_CASE("laps - indoors and in town a place is out of sight for most of the lap") {
  for (const WorldKind kind : {WorldKind::kIndoor, WorldKind::kUrban})
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      CAPTURE(static_cast<int>(kind));
      CAPTURE(seed);
      const Simulator simulator(laps_of(kind, 1, seed));
      const auto place = [&](double share) {
        const double t = time_at(simulator, share * simulator.world().lap_m);
        return Eigen::Vector3d(simulator.drive().piece(0).pose(t).translation());
      };
      for (const double start : {0.0, 0.1, 0.25}) {
        int seen = 0;
        constexpr int kPlaces = 100;
        for (int i = 0; i < kPlaces; ++i)
          if (sees(simulator.world().scene, place(i / double{kPlaces}), place(start))) ++seen;
        CHECK(seen < 40);
        CHECK(seen > 3);
      }
    }
}

TEST_CASE("laps - other people and other traffic are met in each lap") {
  for (const WorldKind kind : {WorldKind::kIndoor, WorldKind::kUrban}) {
    const Simulator simulator(laps_of(kind, 3));
    const double lap_s = simulator.seconds() / 3;
    int elsewhere = 0, movers = 0;
    for (const Mover& mover : simulator.world().movers) {
      if (mover.in_convoy) continue;
      const double moved = std::remainder(mover.speed * lap_s, mover.path.length());
      elsewhere += std::abs(moved) > 5 ? 1 : 0;
      ++movers;
    }
    CHECK(movers >= 6);
    CHECK(elsewhere > 0.7 * movers);
  }
}

TEST_CASE("laps - seconds end a drive of laps where they come first, and events come within it") {
  SimulationConfig config = laps_of(WorldKind::kIndoor, 1);
  const double lap_s = Simulator(config).seconds();
  CHECK(lap_s > 250 / 1.2);
  CHECK(lap_s < 600);
  config.seconds = 30;
  CHECK(Simulator(config).seconds() == 30);
  config.seconds = 3000;
  CHECK(Simulator(config).seconds() == lap_s);
  config.seconds.reset();
  config.events = {parse_event("shake@100+2")};  // later than the 60 s of a drive without laps
  CHECK(Simulator(config).seconds() == lap_s);
  config.events = {parse_event("shake@1000+2")};
  CHECK_THROWS_AS(Simulator{config}, std::invalid_argument);
}

TEST_CASE("laps - a tunnel, a wrong number of laps and too long a drive are refused") {
  CHECK_THROWS_WITH_AS(Simulator{laps_of(WorldKind::kTunnel, 2)}, doctest::Contains("tunnel has no laps"),
                       std::invalid_argument);
  CHECK_THROWS_AS(Simulator{laps_of(WorldKind::kIndoor, 0)}, std::invalid_argument);
  CHECK_THROWS_AS(Simulator{laps_of(WorldKind::kIndoor, 1001)}, std::invalid_argument);
  SimulationConfig slow = laps_of(WorldKind::kIndoor, 5);
  slow.speed_mps = 0.01;
  CHECK_THROWS_WITH_AS(Simulator{slow}, doctest::Contains("more than 90000"), std::invalid_argument);
}
