// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Voxels: the cells in which ground is looked for, of a cloud thinned by that voxel.
inline constexpr float kGroundCell = 4;

/// Each point's height above the lowest point in the square of nine `cell`s (metres) about it, in a levelled
/// cloud. Unlike z it does not depend on where the origin is. Points are finite.
std::vector<float> heights_above_ground(const PointCloud& cloud, float cell);

/// The origin's height, metres, above the ground that a levelled cloud with normals shows about it; none
/// where it shows none below.
std::optional<float> height_above_ground(const PointCloud& cloud, float cell);

}  // namespace scanlock
