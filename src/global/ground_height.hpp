// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Edge, in voxels, of the cells whose lowest point is taken for the ground.
inline constexpr float kGroundCell = 4;

/// The height of each point of a levelled cloud above the lowest point in the square of nine cells around it,
/// metres; `cell`: edge of a cell, metres. Unlike z, it does not depend on the origin. Points are finite.
std::vector<float> heights_above_ground(const PointCloud& cloud, float cell);

/// The height of the origin, metres, above the ground around it in a levelled cloud with normals; nullopt if
/// there is no level surface below the origin.
std::optional<float> height_above_ground(const PointCloud& cloud, float cell);

}  // namespace scanlock
