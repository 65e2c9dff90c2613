// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Which of the points `some` (sensor frame) belong to things that stand alone, as posts, trunks, bushes and
/// legs of chairs do: 1 where all that is beside them at their elevation lies farther off, or is empty, from
/// at most `reach` metres aside on. What continues to one side towards the sensor is a surface seen at a
/// grazing angle, of which points stand apart by the pattern of the sensor alone, and move with it.
/// `points` at `indices`: the scan as it came, of which `some` are a part.
std::vector<std::uint8_t> standing_alone(const PointCloud& points, const std::vector<std::uint32_t>& indices,
                                         const PointCloud& some, float reach);

}  // namespace scanlock
