// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/laps.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr double kTail = 40;  // metres of route beyond the end of the drive, for the car in front

std::vector<Eigen::Vector2d> round_average(const std::vector<Eigen::Vector2d>& in, int half) {
  const int n = static_cast<int>(in.size());
  half = std::min(half, (n - 1) / 2);
  std::vector<Eigen::Vector2d> out(in.size());
  for (int i = 0; i < n; ++i) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int k = -half; k <= half; ++k) sum += in[(i + k + n) % n];
    out[i] = sum / (2 * half + 1);
  }
  return out;
}

/// Offset to the left at each of `count` points, `spacing` metres apart: random values, with a smooth
/// transition (first and second derivatives 0 at both ends) from each value to the next.
std::vector<double> wandering(const Wander& wander, std::size_t count, double spacing, Random& random) {
  const auto draw = [&] { return random.uniform(-wander.aside_m, wander.aside_m); };
  std::vector<double> aside(count);
  double from = draw(), to = draw(), begin = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double s = spacing * static_cast<double>(i);
    for (; s >= begin + wander.every_m; begin += wander.every_m) {
      from = to;
      to = draw();
    }
    const double u = (s - begin) / wander.every_m;
    aside[i] = from + (to - from) * u * u * u * (10 + u * (6 * u - 15));
  }
  return aside;
}

}  // namespace

Polyline closed_lap(const std::vector<Eigen::Vector2d>& corners, double spacing, double width) {
  std::vector<Eigen::Vector2d> points = corners;
  points.push_back(corners.front());
  points = Polyline(points).resampled(spacing).points();
  points.pop_back();
  const int half = std::max(1, static_cast<int>(std::lround(width / spacing / 2)));
  for (int pass = 0; pass < 3; ++pass) points = round_average(points, half);
  points.push_back(points.front());
  return Polyline(points).resampled(spacing);
}

void set_laps(World& world, const Polyline& lap, int laps, const Wander& wander, Random& random) {
  const DriveStyle& style = world.style;
  const std::size_t round = lap.points().size() - 1;
  const double spacing = lap.length() / static_cast<double>(round);
  const double braking = style.fast_mps * style.fast_mps / (2 * style.brake);
  const auto steps = [&](double metres) { return static_cast<std::size_t>(std::ceil(metres / spacing)); };
  const std::size_t driven = static_cast<std::size_t>(laps) * round + steps(kBeyondLap);

  std::vector<Eigen::Vector2d> points(driven + steps(braking + kTail) + 1);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = lap.points()[i % round];
  const std::vector<double> aside = wandering(wander, points.size(), spacing, random);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d along = lap.points()[(i + 1) % round] - lap.points()[(i + round - 1) % round];
    points[i] += aside[i] * Eigen::Vector2d(-along.y(), along.x()).normalized();
  }
  world.route = Polyline(points);
  world.lap_m = lap.length();
  points.resize(driven + 1);
  world.laps_end_m = Polyline(points).length();
}

}  // namespace scanlock
