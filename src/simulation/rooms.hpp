// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "simulation/changes.hpp"
#include "simulation/random.hpp"
#include "simulation/scene.hpp"

namespace scanlock {

// Metres: how thick the walls of rooms are, how wide and high their doorways.
constexpr double kWall = 0.15, kDoor = 1.1, kDoorHeight = 2.1;

/// A block along the axes.
void add_block(Scene& scene, double x0, double x1, double y0, double y1, double z0, double z1,
               double reflectivity);

/// A wall along x at y..y + kWall, with a doorway around each of `doors`.
void add_wall_with_doors(Scene& scene, double ceiling, double x0, double x1, double y,
                         const std::vector<double>& doors);

/// Furniture between x0..x1, y0..y1, but not within 0.75 m of the way along y through the door at x = `door`.
void furnish_room(Scene& scene, double x0, double x1, double y0, double y1, double door, Random& random,
                  Changes& changes);

}  // namespace scanlock
