// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "simulation/random.hpp"
#include "simulation/world.hpp"

namespace scanlock {

/// The closed curve through `corners` and back to the first of them, its corners rounded as
/// Polyline::smoothed does it, without a beginning or an end. Its last point is its first.
Polyline closed_lap(const std::vector<Eigen::Vector2d>& corners, double spacing, double width);

/// How a carrier keeps to its lap: sideways by up to `aside_m`, by another amount each `every_m` of way.
struct Wander {
  double aside_m, every_m;
};

/// Metres by which the last lap goes on beyond its start, so that it is closed like those before it.
constexpr double kBeyondLap = 10;

/// Gives the world a route of `laps` rounds of a closed lap, wandering, and a way to brake or to drive behind
/// another car beyond its end.
void set_laps(World& world, const Polyline& lap, int laps, const Wander& wander, Random& random);

}  // namespace scanlock
