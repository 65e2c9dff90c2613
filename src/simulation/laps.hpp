// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "simulation/random.hpp"
#include "simulation/world.hpp"

namespace scanlock {

/// The closed curve through `corners` and back to the first corner, with all corners, the first included,
/// rounded as in Polyline::smoothed(). Its last point equals its first. `spacing` and `width`: metres.
Polyline closed_lap(const std::vector<Eigen::Vector2d>& corners, double spacing, double width);

/// Deviation of the carrier from its lap: sideways by up to `aside_m`, changing to a new value every
/// `every_m` metres of the route.
struct Wander {
  double aside_m, every_m;
};

/// Metres by which the last lap continues beyond its start, so that it is closed like the laps before it.
constexpr double kBeyondLap = 10;

/// Gives the world a route of `laps` rounds of a closed lap, with deviations, and a continuation beyond its
/// end for braking and for the car in front.
void set_laps(World& world, const Polyline& lap, int laps, const Wander& wander, Random& random);

}  // namespace scanlock
