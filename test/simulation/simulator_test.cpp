// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/simulator.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "../geometry/bit_hash.hpp"
#include "brute_force.hpp"
#include "geometry/angles.hpp"

using namespace scanlock;

namespace {

SimulationConfig config_of(WorldKind world, LidarKind lidar, double seconds) {
  SimulationConfig config;
  config.world = world;
  config.lidar = lidar;
  config.seconds = seconds;
  config.seed = 11;
  return config;
}

std::vector<SimulatedScan> all_scans(const SimulationConfig& config) {
  Simulator simulator(config);
  std::vector<SimulatedScan> scans;
  while (auto scan = simulator.next()) scans.push_back(std::move(*scan));
  return scans;
}

bool same(const Scan& a, const Scan& b) {
  return a.utime == b.utime && a.points.x == b.points.x && a.points.y == b.points.y &&
         a.points.z == b.points.z && a.points.intensity == b.points.intensity &&
         a.points.time == b.points.time;
}

/// Distances of every 7th point from the world's surfaces, each point placed by the pose at its own time,
/// or all by the pose at the stamp.
std::vector<double> surface_distances(const Simulator& simulator, const SimulatedScan& scan,
                                      double sweep_begin, bool own_times) {
  std::vector<double> distances;
  const PointCloud& points = scan.scan.points;
  for (std::size_t i = 0; i < points.size(); i += 7) {
    const double t = scan.time_s + (own_times ? static_cast<double>(points.time[i]) : 0);
    const Eigen::Vector3d p = simulator.pose_at(t, sweep_begin) * points.point(i).cast<double>();
    distances.push_back(distance_to_surfaces(simulator.world().scene, p));
  }
  std::sort(distances.begin(), distances.end());
  return distances;
}

double quantile(const std::vector<double>& sorted, double q) {
  return sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))];
}

/// The scan of the fastest turn.
SimulatedScan fastest_turn(Simulator& simulator) {
  SimulatedScan fastest;
  while (auto scan = simulator.next())
    if (std::abs(scan->twist[5]) > std::abs(fastest.twist[5])) fastest = std::move(*scan);
  return fastest;
}

/// A hash of all poses and points.
std::uint64_t hash_of(const SimulationConfig& config) {
  BitHash hash;
  for (const SimulatedScan& simulated : all_scans(config)) {
    for (const double x : simulated.world_from_body.matrix().reshaped()) hash.add(x);
    const PointCloud& points = simulated.scan.points;
    for (const auto* column : {&points.x, &points.y, &points.z, &points.intensity, &points.time})
      for (const float x : *column) hash.add(static_cast<double>(x));
  }
  return hash.value();
}

}  // namespace

TEST_CASE("simulator - the true motion puts the points of a turning scan on the surfaces") {
  for (const bool stamp_at_end : {false, true}) {
    SimulationConfig config = config_of(WorldKind::kIndoor, LidarKind::kVlp16, 14);
    config.noise_m = 0;
    config.stamp_at_end = stamp_at_end;
    config.threads = 2;
    Simulator simulator(config);
    const SimulatedScan scan = fastest_turn(simulator);
    REQUIRE(std::abs(scan.twist[5]) > 1);
    const double begin = scan.time_s - (stamp_at_end ? 0.1 : 0);
    const auto exact = surface_distances(simulator, scan, begin, true);
    const auto distorted = surface_distances(simulator, scan, begin, false);
    // Half of the 2 mm step of ranges; other points may be on moving people.
    CHECK(quantile(exact, 0.95) < 0.0012);
    CHECK(quantile(distorted, 0.5) > 0.02);
    const auto [first, last] =
        std::minmax_element(scan.scan.points.time.begin(), scan.scan.points.time.end());
    CHECK(*first >= (stamp_at_end ? -0.1001f : 0.0f));
    CHECK(*last <= (stamp_at_end ? 0.0f : 0.1f));
  }
}

TEST_CASE("simulator - noise has the requested size") {
  SimulationConfig config = config_of(WorldKind::kIndoor, LidarKind::kPlanar, 3);
  config.noise_m = 0;
  const auto clean = all_scans(config);
  config.noise_m = 0.03;
  const auto noisy = all_scans(config);
  std::vector<double> errors;
  for (std::size_t k = 0; k < clean.size(); ++k) {
    std::size_t j = 0;  // the same beams, except those that are within the range limits in one of both only
    for (std::size_t i = 0; i < clean[k].scan.points.size(); ++i) {
      const float t = clean[k].scan.points.time[i];
      while (j < noisy[k].scan.points.size() && noisy[k].scan.points.time[j] < t) ++j;
      if (j < noisy[k].scan.points.size() && noisy[k].scan.points.time[j] == t)
        errors.push_back(
            static_cast<double>(noisy[k].scan.points.point(j).norm() - clean[k].scan.points.point(i).norm()));
    }
  }
  REQUIRE(errors.size() > 5000);
  double mean = 0, square = 0;
  for (const double error : errors) mean += error / static_cast<double>(errors.size());
  for (const double error : errors) square += error * error / static_cast<double>(errors.size());
  CHECK(std::abs(mean) < 0.002);
  CHECK(std::sqrt(square) == doctest::Approx(0.03).epsilon(0.05));
}

TEST_CASE("simulator - the same seed gives the same scans for any number of threads, another seed others") {
  SimulationConfig config = config_of(WorldKind::kUrban, LidarKind::kVlp16, 0.5);
  const auto one = all_scans(config);
  config.threads = 3;
  const auto three = all_scans(config);
  config.seed = 12;
  const auto other = all_scans(config);
  REQUIRE(one.size() == 5);
  REQUIRE(three.size() == 5);
  for (std::size_t i = 0; i < one.size(); ++i) {
    CHECK(same(one[i].scan, three[i].scan));
    CHECK(one[i].world_from_body.matrix() == three[i].world_from_body.matrix());
    CHECK_FALSE(same(one[i].scan, other[i].scan));
  }
}

TEST_CASE("simulator - worlds, routes and noise are the same bits with every compiler on every machine") {
  // Together these cover all code that draws random numbers: a mid360 sees everything nearby.
  struct Expected {
    WorldKind world;
    std::optional<int> laps;
    std::uint64_t hash;
  };
  for (const Expected& expected : {Expected{WorldKind::kUrban, {}, 0x0b374ea6ab5d8183},
                                   Expected{WorldKind::kUrban, 1, 0xb2005cf9ea39f84a},
                                   Expected{WorldKind::kIndoor, {}, 0x01131e7bac6d0740},
                                   Expected{WorldKind::kIndoor, 1, 0x40e6dadee2abb45f},
                                   Expected{WorldKind::kForest, {}, 0x3400006a2541c1e2},
                                   Expected{WorldKind::kField, 1, 0x754283c91b194fa2},
                                   Expected{WorldKind::kTunnel, {}, 0xfd31e368440c62bb}}) {
    CAPTURE(static_cast<int>(expected.world));
    CAPTURE(expected.laps.has_value());
    SimulationConfig config = config_of(expected.world, LidarKind::kMid360, 8);
    config.laps = expected.laps;
    config.events = {parse_event("kidnap@7.5"), parse_event("shake@1+2"), parse_event("dropout@0.3+7")};
    config.threads = 2;
    CHECK(hash_of(config) == expected.hash);
  }
}

TEST_CASE("simulator - every lidar in every world sees something, finite and within its range") {
  for (const WorldKind world :
       {WorldKind::kUrban, WorldKind::kIndoor, WorldKind::kForest, WorldKind::kTunnel, WorldKind::kField})
    for (const LidarKind lidar :
         {LidarKind::kVlp16, LidarKind::kHdl64, LidarKind::kOs1_64, LidarKind::kMid360, LidarKind::kPlanar}) {
      Simulator simulator(config_of(world, lidar, 0.1));
      const auto scan = simulator.next();
      REQUIRE(scan);
      CAPTURE(static_cast<int>(world));
      CAPTURE(static_cast<int>(lidar));
      const PointCloud& points = scan->scan.points;
      if (lidar != LidarKind::kPlanar)
        CHECK(points.size() > 500);  // a planar sensor above a field has hardly any returns
      CHECK(points.has_times());
      CHECK(points.has_intensity());
      bool good = true;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double range = static_cast<double>(points.point(i).norm());
        good = good && range > simulator.lidar().min_range - 0.001 &&
               range < simulator.lidar().max_range + 0.001;
      }
      CHECK(good);
      CHECK_FALSE(simulator.next());
    }
}

TEST_CASE("simulator - a step of columns keeps every so many-th one, at its time") {
  LidarModel vlp16 = LidarModel::of(LidarKind::kVlp16);
  const std::vector<Beam> all = vlp16.sweep(0);
  vlp16.column_step = 4;
  const std::vector<Beam> few = vlp16.sweep(0);
  REQUIRE(4 * few.size() == all.size());
  for (std::size_t i = 0; i < few.size(); ++i) {
    const Beam& same = all[i / 16 * 64 + i % 16];
    CHECK(few[i].time == same.time);
    CHECK(few[i].direction == same.direction);
  }
}

TEST_CASE("simulator - the rosette leaves no gap, and the next scan is no rotated copy") {
  const LidarModel mid360 = LidarModel::of(LidarKind::kMid360);
  // The azimuths, degrees, at which its scan lines cross the elevation of 20 degrees.
  const auto crossings = [&](std::int64_t scan) {
    std::vector<double> azimuths;
    double before = 0;
    for (const Beam& beam : mid360.sweep(scan)) {
      const double elevation = std::asin(beam.direction.z()) / kDegree - 20;
      if (elevation * before < 0)
        azimuths.push_back(std::atan2(beam.direction.y(), beam.direction.x()) / kDegree);
      before = elevation;
    }
    std::sort(azimuths.begin(), azimuths.end());
    return azimuths;
  };
  const std::vector<double> lines = crossings(7), next = crossings(8);
  REQUIRE(lines.size() > 200);
  for (std::size_t i = 1; i < lines.size(); ++i) CHECK(lines[i] - lines[i - 1] < 4.5);
  for (double turned = -2; turned <= 2; turned += 0.1) {
    int met = 0;
    for (double azimuth : lines) {
      const auto at = std::lower_bound(next.begin(), next.end(), azimuth + turned - 0.1);
      met += at != next.end() && *at < azimuth + turned + 0.1 ? 1 : 0;
    }
    CHECK(met < 0.9 * static_cast<double>(lines.size()));
  }
}

TEST_CASE("simulator - without distortion every point is taken at the stamp") {
  SimulationConfig config = config_of(WorldKind::kIndoor, LidarKind::kVlp16, 10);
  config.noise_m = 0;
  config.motion_distortion = false;
  Simulator simulator(config);
  const SimulatedScan scan = fastest_turn(simulator);
  CHECK(quantile(surface_distances(simulator, scan, scan.time_s, false), 0.95) < 0.0012);
  CHECK(std::all_of(scan.scan.points.time.begin(), scan.scan.points.time.end(),
                    [](float t) { return t == 0; }));
}

TEST_CASE("simulator - the true pose holds at the stamp, and its steps agree with the velocity") {
  for (const bool stamp_at_end : {false, true}) {
    SimulationConfig config = config_of(WorldKind::kUrban, LidarKind::kPlanar, 30);
    config.stamp_at_end = stamp_at_end;
    const auto scans = all_scans(config);
    REQUIRE(scans.size() == 300);
    CHECK(scans[0].scan.utime == Simulator::kStartUtime + (stamp_at_end ? 100000 : 0));
    for (std::size_t i = 1; i < scans.size(); ++i) {
      CHECK(scans[i].scan.utime - scans[i - 1].scan.utime == 100000);
      const Vector6 step = se3_log(scans[i - 1].world_from_body.inverse() * scans[i].world_from_body) / 0.1;
      CHECK((step - (scans[i].twist + scans[i - 1].twist) / 2).norm() < 0.2);
    }
  }
}

TEST_CASE("simulator - dropout, blackout, halfview and kidnap have their effects") {
  SimulationConfig config = config_of(WorldKind::kUrban, LidarKind::kVlp16, 12);
  config.threads = 2;
  config.events = {parse_event("dropout@2+1"), parse_event("blackout@4+1"), parse_event("halfview@6+1"),
                   parse_event("kidnap@9.04")};
  const auto scans = all_scans(config);
  CHECK(scans.size() == 110);
  double largest_step = 0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const SimulatedScan& scan = scans[i];
    const double t = scan.time_s;
    CAPTURE(t);
    CHECK_FALSE((t > 1.95 && t < 2.95));
    const PointCloud& points = scan.scan.points;
    const bool left = std::any_of(points.y.begin(), points.y.end(), [](float y) { return y > 0; });
    const bool right = std::any_of(points.y.begin(), points.y.end(), [](float y) { return y < 0; });
    if (t > 3.95 && t < 4.95) {
      CHECK(points.size() <= 20);
    } else {
      CHECK(points.size() > 5000);
      CHECK(right);
      CHECK(left != (t > 5.95 && t < 6.95));
    }
    if (i == 0 || t - scans[i - 1].time_s > 0.15) continue;
    const double step =
        (scan.world_from_body.translation() - scans[i - 1].world_from_body.translation()).norm();
    if (t > 9.05 && t < 9.15) {
      CHECK(step > 1.5);
      CHECK(step < 16.5);
    } else {
      largest_step = std::max(largest_step, step);
    }
  }
  CHECK(largest_step < 1.5);  // 14 m/s
}

TEST_CASE("simulator - an invalid configuration is refused") {
  SimulationConfig config;
  config.seconds = 0;
  CHECK_THROWS_AS(Simulator{config}, std::invalid_argument);
  config.seconds = 10;
  config.noise_m = -1.0;
  CHECK_THROWS_AS(Simulator{config}, std::invalid_argument);
  config.noise_m = 0.02;
  config.column_step = 0;
  CHECK_THROWS_AS(Simulator{config}, std::invalid_argument);
  CHECK_THROWS_AS(parse_world("moon"), std::invalid_argument);
  CHECK_THROWS_AS(parse_lidar("vlp32"), std::invalid_argument);
}
