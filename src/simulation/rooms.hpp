// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "simulation/changes.hpp"
#include "simulation/random.hpp"
#include "simulation/scene.hpp"

namespace scanlock {

// Metres: thickness of walls, width and height of doorways.
constexpr double kWall = 0.15, kDoor = 1.1, kDoorHeight = 2.1;

/// Adds a box parallel to the axes.
void add_block(Scene& scene, double x0, double x1, double y0, double y1, double z0, double z1,
               double reflectivity);

/// Adds a wall along x at y..y + kWall, with a doorway centred at each of `doors`.
void add_wall_with_doors(Scene& scene, double ceiling, double x0, double x1, double y,
                         const std::vector<double>& doors);

/// Adds furniture between x0..x1 and y0..y1, except within 0.75 m of the path along y through the door at x =
/// `door`.
void furnish_room(Scene& scene, double x0, double x1, double y0, double y1, double door, Random& random,
                  Changes& changes);

}  // namespace scanlock
