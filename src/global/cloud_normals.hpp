// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Least |vertical component of the normal| of a level surface in a levelled cloud; level surfaces look alike
/// everywhere.
inline constexpr float kLevel = 0.8f;

/// Whether point i of a levelled cloud has a normal, and its surface is not level.
inline bool is_steep(const PointCloud& cloud, std::size_t i) {
  return std::abs(cloud.nz[i]) < kLevel && cloud.normal(i).squaredNorm() > 0.5f;
}

/// Sets the unit normal of each point, fitted to the neighbours within `radius` metres and pointing towards
/// the sensor origin of the point; zero where there are fewer than five neighbours or they span no plane. If
/// the cloud has normals already, these are normalised and kept.
void add_normals(PointCloud* cloud, float radius);

}  // namespace scanlock
