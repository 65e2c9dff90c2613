// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "simulation/polyline.hpp"
#include "simulation/random.hpp"

namespace scanlock {

// Distances from the middle of a street, metres: the middle of a lane (traffic keeps right), the kerb, and
// where gardens and houses may begin.
constexpr double kLane = 1.75, kKerb = 5.8, kCorridor = 9.0;

/// A town: wavy streets in two directions that cross.
struct StreetPlan {
  int across = 0;  ///< how many run along x (the first ones of `streets`); the others run along y
  std::vector<Polyline> streets;
  std::vector<std::vector<Eigen::Vector2d>> crossings;  ///< [street along y][street along x]
  Eigen::Vector2d low, high;

  /// True when p is farther than `distance` from the middle of every street but `own`.
  bool clear_of_others(std::size_t own, const Eigen::Vector2d& p, double distance) const;
};

StreetPlan plan_streets(Random& random);

/// A drive of at least `length` through the town, in the right lane, turning at random and never back at
/// once.
Polyline plan_route(const StreetPlan& plan, double length, Random& random);

/// The way around the blocks whose circumference is nearest to `length`, in the right lane and in either
/// direction, from the middle of a street; its last point is its first.
Polyline plan_loop(const StreetPlan& plan, double length, Random& random);

}  // namespace scanlock
