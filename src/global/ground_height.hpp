// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Edge, in voxels, of the cells in which the lowest point is taken for the ground.
inline constexpr float kGroundCell = 4;

/// Each point's height above the lowest point in the square of nine `cell`s (metres) about it, in a levelled
/// cloud. Unlike z it does not depend on where the origin is. Points are finite.
std::vector<float> heights_above_ground(const PointCloud& cloud, float cell);

/// The height of the origin, metres, above the ground around it in a levelled cloud with normals; nothing
/// where there is no level surface below the origin.
std::optional<float> height_above_ground(const PointCloud& cloud, float cell);

}  // namespace scanlock
