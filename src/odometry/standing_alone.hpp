// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// For each of the points `some` (sensor frame) 1 where it is of an isolated object, such as a post, a trunk,
/// a bush or the leg of a chair, else 0. It is isolated if on both sides, at its elevation, ranges become
/// larger or returns end at most `reach` metres aside. Points that continue on one side towards the sensor
/// are not isolated: they are of a surface seen at a grazing angle, and are apart only by the pattern of the
/// sensor, with which they move. `points` at `indices`: the scan as it came, of which `some` are a part.
std::vector<std::uint8_t> standing_alone(const PointCloud& points, const std::vector<std::uint32_t>& indices,
                                         const PointCloud& some, float reach);

}  // namespace scanlock
