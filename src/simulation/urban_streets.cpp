// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/urban_streets.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/elementary.hpp"
#include "simulation/laps.hpp"

namespace scanlock {
namespace {

constexpr int kStreets = 7;     // in each direction
constexpr double kBeyond = 25;  // metres of street beyond the last crossing
constexpr double kSpacing = 0.5,
                 kBend = 9;  // metres: spacing of a route's points; length over which corners are rounded

/// The centre line of a street as a function of the coordinate along which it runs.
struct Wave {
  double base, amplitude, length, phase;
  double at(double u) const { return base + amplitude * sin(u / length + phase); }
};

std::vector<Wave> make_waves(Random& random) {
  std::vector<Wave> waves;
  double base = 0;
  for (int i = 0; i < kStreets; ++i) {
    waves.push_back({base, random.uniform(1, 6), random.uniform(35, 60), random.uniform(0, 6.28)});
    base += random.uniform(65, 110);
  }
  return waves;
}

Polyline sample_street(const Wave& wave, double from, double to, bool along_x) {
  std::vector<Eigen::Vector2d> points;
  for (double u = from; u <= to; u += 1)
    points.push_back(along_x ? Eigen::Vector2d(u, wave.at(u)) : Eigen::Vector2d(wave.at(u), u));
  return Polyline(points);
}

const Eigen::Vector2i kSteps[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};  // by heading

/// The right lane from one crossing to the next, without 6 m at both ends, where the bends are.
Polyline lane_between(const StreetPlan& plan, const Eigen::Vector2i& at, int heading) {
  const Eigen::Vector2i to = at + kSteps[heading];
  const bool along_x = heading % 2 == 0;
  const Polyline& street = plan.streets[along_x ? at.y() : plan.across + at.x()];
  const Eigen::Vector2d from_point = plan.crossings[at.x()][at.y()],
                        to_point = plan.crossings[to.x()][to.y()];
  std::vector<Eigen::Vector2d> leg;
  for (const Eigen::Vector2d& p : street.points()) {
    const double u = along_x ? p.x() : p.y();
    const double a = along_x ? from_point.x() : from_point.y(), b = along_x ? to_point.x() : to_point.y();
    if (u > std::min(a, b) + 6 && u < std::max(a, b) - 6) leg.push_back(p);
  }
  if (heading >= 2) std::reverse(leg.begin(), leg.end());
  return Polyline(leg).offset(-kLane);
}

/// The rectangle of blocks between two crossings, each as [street along y, street along x].
struct Blocks {
  Eigen::Vector2i low, high;
};

double circumference(const StreetPlan& plan, const Blocks& blocks) {
  const auto crossing = [&](int i, int j) -> const Eigen::Vector2d& { return plan.crossings[i][j]; };
  const Eigen::Vector2d a = crossing(blocks.low.x(), blocks.low.y()),
                        b = crossing(blocks.high.x(), blocks.low.y()),
                        c = crossing(blocks.high.x(), blocks.high.y()),
                        d = crossing(blocks.low.x(), blocks.high.y());
  return (b - a).norm() + (c - b).norm() + (d - c).norm() + (a - d).norm();
}

Blocks blocks_around(const StreetPlan& plan, double length) {
  Blocks best{{0, 0}, {1, 1}};
  for (int i = 0; i < kStreets; ++i)
    for (int j = 0; j < kStreets; ++j)
      for (int k = i + 1; k < kStreets; ++k)
        for (int m = j + 1; m < kStreets; ++m) {
          const Blocks blocks{{i, j}, {k, m}};
          if (std::abs(circumference(plan, blocks) - length) < std::abs(circumference(plan, best) - length))
            best = blocks;
        }
  return best;
}

}  // namespace

bool StreetPlan::clear_of_others(std::size_t own, const Eigen::Vector2d& p, double distance) const {
  for (std::size_t i = 0; i < streets.size(); ++i) {
    if (i == own) continue;
    // Streets are sampled every metre along their axis: only the stretch beside p is searched.
    const auto& points = streets[i].points();
    const bool along_x = static_cast<int>(i) < across;
    const double u = along_x ? p.x() - points.front().x() : p.y() - points.front().y();
    const int last = static_cast<int>(points.size()) - 1;
    const int middle = std::clamp(static_cast<int>(u), 0, last), reach = static_cast<int>(distance) + 1;
    for (int k = std::max(0, middle - reach); k <= std::min(last, middle + reach); ++k)
      if ((points[k] - p).squaredNorm() < distance * distance) return false;
  }
  return true;
}

StreetPlan plan_streets(Random& random) {
  const std::vector<Wave> along_x = make_waves(random), along_y = make_waves(random);
  StreetPlan plan;
  plan.across = kStreets;
  const double x_end = along_y.back().base + kBeyond, y_end = along_x.back().base + kBeyond;
  for (const Wave& wave : along_x) plan.streets.push_back(sample_street(wave, -kBeyond, x_end, true));
  for (const Wave& wave : along_y) plan.streets.push_back(sample_street(wave, -kBeyond, y_end, false));
  plan.crossings.resize(along_y.size());
  for (std::size_t i = 0; i < along_y.size(); ++i)
    for (const Wave& horizontal : along_x) {
      double x = along_y[i].base;
      for (int pass = 0; pass < 30; ++pass) x = along_y[i].at(horizontal.at(x));
      plan.crossings[i].push_back({x, horizontal.at(x)});
    }
  plan.low = Eigen::Vector2d::Constant(-kBeyond - 30);
  plan.high = Eigen::Vector2d(x_end, y_end) + Eigen::Vector2d::Constant(30);
  return plan;
}

Polyline plan_route(const StreetPlan& plan, double length, Random& random) {
  Eigen::Vector2i at(kStreets / 2, kStreets / 2);
  int heading = random.integer(0, 3);
  std::vector<Eigen::Vector2d> points;
  double driven = 0;
  const auto inside = [](const Eigen::Vector2i& p) { return p.minCoeff() >= 0 && p.maxCoeff() < kStreets; };
  while (driven < length + 50) {
    const Polyline lane = lane_between(plan, at, heading);
    points.insert(points.end(), lane.points().begin(), lane.points().end());
    driven += lane.length() + 12;

    at += kSteps[heading];
    const int straight = heading;
    do {  // straight on, left or right with equal probability, within the town
      heading = (straight + random.integer(-1, 1) + 4) % 4;
    } while (!inside(at + kSteps[heading]));
  }
  return Polyline(points).smoothed(kSpacing, kBend);
}

Polyline plan_loop(const StreetPlan& plan, double length, Random& random) {
  const Blocks blocks = blocks_around(plan, length);
  const int first = random.integer(0, 1), turn = first == 0 ? 1 : -1;  // all left turns or all right turns
  Eigen::Vector2i at = blocks.low;
  std::vector<Eigen::Vector2d> points;
  std::size_t half_a_leg = 0;
  for (int side = 0, heading = first; side < 4; ++side, heading = (heading + turn + 4) % 4) {
    const Eigen::Vector2i reach = blocks.high - blocks.low;
    for (int block = 0; block < reach[heading % 2]; ++block, at += kSteps[heading]) {
      const Polyline lane = lane_between(plan, at, heading);
      if (points.empty()) half_a_leg = lane.points().size() / 2;
      points.insert(points.end(), lane.points().begin(), lane.points().end());
    }
  }
  std::rotate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(half_a_leg), points.end());
  return closed_lap(points, kSpacing, kBend);
}

}  // namespace scanlock
