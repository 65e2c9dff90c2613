// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "simulation/random.hpp"
#include "simulation/scene.hpp"
#include "simulation/urban_streets.hpp"

namespace scanlock {

/// Adds houses of random widths, heights and setbacks along one side (+1 left, -1 right) of a street, with
/// walls or hedges in the gaps between them; none of them stands on another street.
void add_buildings(Scene& scene, const StreetPlan& plan, std::size_t street, double side, Random& random);

}  // namespace scanlock
