// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// For each of the points `some` (sensor frame) whether it is of an isolated object, as a post, a trunk, a
/// bush or the leg of a chair: 1 where from at most `reach` metres aside on, to either side at its elevation,
/// ranges are larger or there is no return. Points that continue to one side towards the sensor are of a
/// surface seen at a grazing angle: they lie apart by the pattern of the sensor alone, and move with it.
/// `points` at `indices`: the scan as it came, of which `some` are a part.
std::vector<std::uint8_t> standing_alone(const PointCloud& points, const std::vector<std::uint32_t>& indices,
                                         const PointCloud& some, float reach);

}  // namespace scanlock
