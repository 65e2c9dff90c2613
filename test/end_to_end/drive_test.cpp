// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "../trials.hpp"
#include "mapping/mapper.hpp"
#include "simulation/simulator.hpp"

using namespace scanlock;

namespace {

/// A tracked scan, and the true pose of the sensor in the frame of the first scan.
struct Step {
  TrackedScan tracked;
  Pose truth;
  double metres_off() const { return (tracked.map_from_body.translation() - truth.translation()).norm(); }
};

/// A drive with a vlp16, through rooms unless another world is given; searches are answered at once. Stamps
/// from 14 s on are `clock_step` microseconds off.
std::vector<Step> simulated_drive(double seconds, std::uint64_t seed, const std::vector<const char*>& events,
                                  std::int64_t clock_step = 0, WorldKind world = WorldKind::kIndoor,
                                  double until_s = 1e9) {
  SimulationConfig config;
  config.world = world;
  config.seconds = seconds;
  config.seed = seed;
  for (const char* event : events) config.events.push_back(parse_event(event));
  Simulator simulator(config);
  Mapper mapper(TrackerConfig{});
  MapWorker worker(TrackerConfig{});
  Pose first_from_world = Pose::Identity();
  std::vector<Step> steps;
  for (auto simulated = simulator.next(); simulated && simulated->time_s < until_s;
       simulated = simulator.next()) {
    if (steps.size() >= 140) simulated->scan.utime += clock_step;
    if (steps.empty()) first_from_world = simulated->world_from_body.inverse();
    steps.push_back({mapper.track(simulated->scan), first_from_world * simulated->world_from_body});
    if (const auto request = mapper.take_request()) mapper.give(worker.work(*request));
  }
  return steps;
}

/// For a robot that is kidnapped without scans: it is TRACKING only at its true pose, and at the end.
void check_found_again(const std::vector<Step>& steps) {
  for (const Step& step : steps)
    if (step.tracked.state == TrackingState::kTracking) CHECK(step.metres_off() < 0.5);
  CHECK(steps.back().tracked.state == TrackingState::kTracking);
  CHECK(steps.back().tracked.epoch == 1);
}

}  // namespace

TEST_SUITE("long drives") {
  TEST_CASE(
      "a robot that is kidnapped while scans are missing is relocalised, and never TRACKING at a wrong "
      "pose") {
    for (const std::uint64_t seed : seeds({3005, 3031})) {
      CAPTURE(seed);
      check_found_again(simulated_drive(17, seed, {"kidnap@14", "dropout@14+0.4"}));
    }
  }

  TEST_CASE("scans without points for two seconds are DEGRADED, and bridged in the same epoch") {
    const std::vector<Step> steps = simulated_drive(22, 992, {"blackout@15+2"});
    for (std::size_t i = 1; i < steps.size(); ++i) {
      const TrackedScan& tracked = steps[i].tracked;
      CHECK(tracked.epoch == 0);
      const bool dark = tracked.verdict == ScanVerdict::kEmpty;
      CHECK(tracked.method == (dark ? PoseMethod::kPredicted : PoseMethod::kIcp));
      if (dark) CHECK(tracked.state == TrackingState::kDegraded);
    }
    CHECK(steps.back().metres_off() < 0.3);
  }

  TEST_CASE(
      "a robot that is kidnapped during scans without points is relocalised, and never TRACKING at a wrong "
      "pose") {
    for (const std::uint64_t seed : seeds({992, 993})) {
      CAPTURE(seed);
      check_found_again(simulated_drive(22, seed, {"blackout@15+2", "kidnap@16"}));
    }
  }

  TEST_CASE("a clock that steps by half a second costs two scans") {
    for (const std::uint64_t seed : seeds({11, 12, 13})) {
      CAPTURE(seed);
      const std::vector<Step> steps = simulated_drive(17, seed, {}, -500000);
      int rejected = 0;
      for (std::size_t i = 1; i < steps.size(); ++i) {
        const TrackedScan& tracked = steps[i].tracked;
        rejected += tracked.verdict != ScanVerdict::kTracked;
        if (tracked.verdict != ScanVerdict::kTracked) continue;
        CHECK(tracked.epoch == 0);
        CHECK(tracked.method == PoseMethod::kIcp);
        CHECK(steps[i].metres_off() < 0.2);
      }
      CHECK(rejected == 2);
    }
  }

  TEST_CASE("gaps of 0.5 s and 1 s between scans are bridged") {
    for (const std::uint64_t seed : seeds({3101, 3102, 3107})) {
      CAPTURE(seed);
      const std::vector<Step> steps = simulated_drive(17, seed, {"dropout@12+0.5", "dropout@15+1"});
      for (std::size_t i = 1; i < steps.size(); ++i) {
        CHECK(steps[i].tracked.method == PoseMethod::kIcp);
        CHECK(steps[i].metres_off() < 0.3);
      }
    }
  }

  TEST_CASE("later laps of a corridor do not enlarge the map, and its poses are right to 0.25 m") {
    SimulationConfig config;
    config.world = WorldKind::kIndoor;
    config.lidar = LidarKind::kPlanar;
    config.laps = all_trials() ? 3 : 2;
    config.speed_mps = 1.5;
    config.seed = 5;
    Simulator simulator(config);
    Mapper mapper(TrackerConfig{});
    mapper.keep_history();
    MapWorker worker(TrackerConfig{});
    std::vector<Step> steps;
    std::vector<std::size_t> nodes;
    Pose first_from_world = Pose::Identity();
    while (auto simulated = simulator.next()) {
      if (steps.empty()) first_from_world = simulated->world_from_body.inverse();
      steps.push_back({mapper.track(simulated->scan), first_from_world * simulated->world_from_body});
      nodes.push_back(mapper.graph().nodes().size());
      if (const auto request = mapper.take_request()) mapper.give(worker.work(*request));
    }
    CHECK(nodes.back() < 1.1 * static_cast<double>(nodes[nodes.size() / 2]));
    CHECK(steps.back().tracked.loop_closures > 10);
    double worst = 0, last = 0;
    for (const Step& step : steps) {
      REQUIRE((step.tracked.stamp || &step == &steps.front()));
      if (!step.tracked.stamp) continue;
      const Pose settled = mapper.correction(*step.tracked.stamp) * step.tracked.map_from_body;
      last = (settled.translation() - step.truth.translation()).head<2>().norm();
      worst = std::max(worst, last);
    }
    CHECK(worst < 0.25);
    CHECK(last < 0.1);
  }
}

TEST_CASE("a robot that stops in a wood is tracked within 0.4 m, without a false turn" *
          doctest::test_suite("long drives") * doctest::skip(!all_trials())) {
  // It stands from 66 to 69 s.
  const std::vector<Step> steps = simulated_drive(90, 7001, {}, 0, WorldKind::kForest, 76);
  // The other scans are DEGRADED: few trees constrain the pose as closely as TRACKING promises.
  int tracking = 0;
  for (std::size_t i = 1; i < steps.size(); ++i) {
    CHECK(steps[i].tracked.method == PoseMethod::kIcp);
    CHECK(steps[i].metres_off() < 0.4);
    tracking += steps[i].tracked.state == TrackingState::kTracking;
  }
  CHECK(tracking > static_cast<int>(0.7 * static_cast<double>(steps.size())));
}
