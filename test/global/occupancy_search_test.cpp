// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/occupancy_search.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "geometry/angles.hpp"

namespace scanlock {
namespace {

/// Scans of a room of random boxes, from random places in it.
struct Room {
  explicit Room(unsigned seed, double half_width = 6) : rng(seed), half(half_width) {
    for (int i = 0; i < 12; ++i) {
      const double x = uniform(-half, half), y = uniform(-half, half);
      const double w = uniform(0.3, 1.5), h = uniform(0.3, 1.5);
      boxes.push_back({x, y, x + w, y + h});
    }
    boxes.push_back({-half - 1, -half - 1, -half, half + 1});
    boxes.push_back({half, -half - 1, half + 1, half + 1});
    boxes.push_back({-half - 1, -half - 1, half + 1, -half});
    boxes.push_back({-half - 1, half, half + 1, half + 1});
  }
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(rng); }
  bool inside(double x, double y) const {
    return std::any_of(boxes.begin(), boxes.end(),
                       [&](const auto& b) { return x > b[0] && x < b[2] && y > b[1] && y < b[3]; });
  }
  /// Adds a scan from (x, y), in axes turned by -yaw about (cx, cy).
  void scan(PointCloud* cloud, double x, double y, double cx, double cy, double yaw) {
    for (int beam = 0; beam < 180; ++beam) {
      const double azimuth = beam * kPi / 90;
      double range = 0;
      while (range < 30 && !inside(x + range * std::cos(azimuth), y + range * std::sin(azimuth)))
        range += 0.01;
      const auto local = [&](double u, double v) {
        const double dx = u - cx, dy = v - cy;
        return Eigen::Vector3f(static_cast<float>(std::cos(yaw) * dx + std::sin(yaw) * dy),
                               static_cast<float>(-std::sin(yaw) * dx + std::cos(yaw) * dy), 0);
      };
      cloud->push_back(local(x + range * std::cos(azimuth), y + range * std::sin(azimuth)));
      cloud->viewpoints.push_back(local(x, y));
    }
  }
  std::array<double, 2> place() {
    for (;;) {
      const double x = uniform(-half, half), y = uniform(-half, half);
      if (!inside(x, y)) return {x, y};
    }
  }
  std::mt19937 rng;
  double half;
  std::vector<std::array<double, 4>> boxes;
};

/// Metres and radians between two poses in the plane.
std::array<double, 2> gap(const OccupancyMatch& a, double x, double y, double yaw) {
  const double turn = a.yaw - yaw;
  return {std::hypot(a.x - x, a.y - y), std::abs(turn - 2 * kPi * std::round(turn / (2 * kPi)))};
}

/// The log-likelihood ratio of a pose, from the definition.
double log_likelihood(const std::vector<OccupancySample>& samples, const OccupancyTarget& target,
                      const Eigen::Array2i& cell, double yaw) {
  int sum = 0;
  for (const OccupancySample& sample : samples) {
    const auto& table = target.table(sample.what, 0);
    const double x = std::cos(yaw) * sample.p.x() - std::sin(yaw) * sample.p.y() + 0.5,
                 y = std::sin(yaw) * sample.p.x() + std::cos(yaw) * sample.p.y() + 0.5;
    const int column = cell.x() - target.low().x() + target.border() + static_cast<int>(std::floor(x)),
              row = cell.y() - target.low().y() + target.border() + static_cast<int>(std::floor(y));
    sum += table.most[static_cast<std::size_t>(row * table.columns + column)];
  }
  return sum * OccupancyTarget::kUnit;
}

}  // namespace

TEST_CASE("the best pose is that of an exhaustive search, and no pose at another place exceeds its bound") {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    CAPTURE(seed);
    Room room(seed, 3);
    PointCloud map, source;
    for (int i = 0; i < 4; ++i) {
      const auto p = room.place();
      room.scan(&map, p[0], p[1], 0, 0, 0);
    }
    const auto p = room.place();
    room.scan(&source, p[0], p[1], p[0], p[1], room.uniform(0, 6));
    const double cell = 0.25;
    const OccupancyGrid grid(source, cell);
    const OccupancyTarget target(OccupancyGrid(map, cell), 20);
    const OccupancyMatches found = search_occupancy(grid, target);
    REQUIRE(found.finished);
    REQUIRE(!found.poses.empty());
    CHECK(found.upper_bound == found.poses.front().log_likelihood);

    const std::vector<OccupancySample> samples = samples_of(grid);
    double reach = 1;
    for (const OccupancySample& sample : samples) reach = std::max(reach, sample.p.norm());
    const int turns = static_cast<int>(std::ceil(2 * kPi * reach));
    double most = 0, elsewhere = 0;
    for (int n = 0; n < turns; ++n) {
      for (int x = 0; x < target.size().x(); ++x) {
        for (int y = 0; y < target.size().y(); ++y) {
          const double yaw = 2 * kPi * n / turns;
          const Eigen::Array2i at = target.low() + Eigen::Array2i(x, y);
          const double value = log_likelihood(samples, target, at, yaw);
          most = std::max(most, value);
          const auto away = gap(found.poses.front(), (at.x() + 0.5) * cell, (at.y() + 0.5) * cell, yaw);
          const OccupancySearchOptions options;
          if (away[0] >= options.distance || away[1] >= options.angle) elsewhere = std::max(elsewhere, value);
        }
      }
    }
    CHECK(found.upper_bound == most);
    CHECK(found.rival_bound >= elsewhere);
    if (found.poses.size() > 1) CHECK(found.rival_bound == elsewhere);
  }
}

TEST_CASE("a search that is cut short proves no more than it knows") {
  Room room(7, 4);
  PointCloud map, source;
  for (int i = 0; i < 6; ++i) {
    const auto p = room.place();
    room.scan(&map, p[0], p[1], 0, 0, 0);
  }
  const auto p = room.place();
  room.scan(&source, p[0], p[1], p[0], p[1], 2);
  const OccupancyGrid grid(source, 0.1);
  const OccupancyTarget target(OccupancyGrid(map, 0.1), 20);
  const OccupancyMatches whole = search_occupancy(grid, target);
  OccupancySearchOptions options;
  options.log_odds = 1000;
  const OccupancyMatches more = search_occupancy(grid, target, options);
  REQUIRE(whole.poses.size() == 1);
  REQUIRE(more.poses.size() > 1);
  CHECK(whole.rival_bound >= more.poses[1].log_likelihood);
  options = {};
  for (const std::size_t work : {whole.work / 50, whole.work / 4, whole.work - 1}) {
    options.max_work = work;
    const OccupancyMatches part = search_occupancy(grid, target, options);
    CHECK(!part.finished);
    CHECK(part.upper_bound >= whole.upper_bound);
    CHECK(part.rival_bound >= whole.rival_bound);
    CHECK(log_odds(part) <= log_odds(whole));
    if (!part.poses.empty()) CHECK(part.poses.front().log_likelihood == whole.poses.front().log_likelihood);
  }
}

TEST_CASE("scans are found in a map of the place, and in that of another place the log odds are below zero") {
  int found_in_own = 0, likely_in_other = 0;
  for (unsigned seed = 11; seed <= 16; ++seed) {
    Room room(seed), other(seed + 100);
    PointCloud map, foreign, source;
    for (int i = 0; i < 8; ++i) {
      const auto p = room.place(), q = other.place();
      room.scan(&map, p[0], p[1], 0, 0, 0);
      other.scan(&foreign, q[0], q[1], 0, 0, 0);
    }
    const auto p = room.place();
    const double yaw = room.uniform(0, 6);
    room.scan(&source, p[0], p[1], p[0], p[1], yaw);
    const OccupancyGrid grid(source, 0.1);
    const OccupancyMatches own = search_occupancy(grid, OccupancyTarget(OccupancyGrid(map, 0.1), 20)),
                           strange = search_occupancy(grid, OccupancyTarget(OccupancyGrid(foreign, 0.1), 20));
    REQUIRE(!own.poses.empty());
    const auto away = gap(own.poses.front(), p[0], p[1], yaw);
    found_in_own += away[0] < 0.15 && away[1] < 0.03 && log_odds(own) > 0 ? 1 : 0;
    likely_in_other += log_odds(strange) > 0 ? 1 : 0;
  }
  CHECK(found_in_own == 6);
  CHECK(likely_in_other == 0);
}

TEST_CASE("half a turn of a symmetric room leaves two places that the odds do not decide between") {
  Room room(1, 5);
  room.boxes = {{-6, -6, -5, 6}, {5, -6, 6, 6},   {-6, -6, 6, -3},
                {-6, 3, 6, 6},   {-2, -1, -1, 0}, {1, 0, 2, 1}};
  PointCloud map, source;
  for (const double x : {-4, 0, 4}) {
    room.scan(&map, x, 2, 0, 0, 0);
    room.scan(&map, -x, -2, 0, 0, 0);
  }
  room.scan(&source, 3, -1, 3, -1, 0.5);
  const OccupancyMatches found =
      search_occupancy(OccupancyGrid(source, 0.1), OccupancyTarget(OccupancyGrid(map, 0.1), 20));
  REQUIRE(found.poses.size() >= 2);
  CHECK(lead_odds(found, found.poses[1].log_likelihood) < 2);
  for (const double turned : {0.0, kPi}) {
    const double x = 3 * std::cos(turned), y = -std::cos(turned);
    const auto is_here = [&](const OccupancyMatch& match) {
      const auto away = gap(match, x, y, 0.5 + turned);
      return away[0] < 0.15 && away[1] < 0.03;
    };
    CHECK(std::any_of(found.poses.begin(), found.poses.begin() + 2, is_here));
  }
}

TEST_CASE("a source without points, or a map without any, leads to no pose") {
  Room room(5);
  PointCloud map;
  room.scan(&map, 0, 0, 0, 0, 0);
  const OccupancyTarget target(OccupancyGrid(map, 0.1), 20), nothing(OccupancyGrid(PointCloud(), 0.1), 20);
  for (const PointCloud& source : {PointCloud(), map}) {
    const OccupancyGrid grid(source, 0.1);
    if (source.empty()) CHECK(search_occupancy(grid, target).poses.empty());
    CHECK(search_occupancy(grid, nothing).poses.empty());
    CHECK(log_odds(search_occupancy(grid, nothing)) < 0);
  }
}

}  // namespace scanlock
