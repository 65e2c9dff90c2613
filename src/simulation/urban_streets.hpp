// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "simulation/polyline.hpp"
#include "simulation/random.hpp"

namespace scanlock {

// Distances from the centre line of a street, metres: the centre of a lane (traffic keeps right), the kerb,
// and the nearest position of gardens and houses.
constexpr double kLane = 1.75, kKerb = 5.8, kCorridor = 9.0;

/// A town: wavy streets in two directions that cross each other.
struct StreetPlan {
  int across = 0;  ///< number of streets along x (the first ones in `streets`); the others run along y
  std::vector<Polyline> streets;
  std::vector<std::vector<Eigen::Vector2d>> crossings;  ///< [street along y][street along x]
  Eigen::Vector2d low, high;

  /// True when p is farther than `distance` from the centre line of every street but `own`.
  bool clear_of_others(std::size_t own, const Eigen::Vector2d& p, double distance) const;
};

StreetPlan plan_streets(Random& random);

/// A route of at least `length` metres through the town, in the right lane, turning at random at crossings
/// without U-turns.
Polyline plan_route(const StreetPlan& plan, double length, Random& random);

/// The loop around the rectangle of blocks whose circumference is nearest to `length` metres, in the right
/// lane, in a random direction, starting in the middle between two crossings; its last point equals its
/// first.
Polyline plan_loop(const StreetPlan& plan, double length, Random& random);

}  // namespace scanlock
