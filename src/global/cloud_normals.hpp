// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// |Vertical component of the normal| from which on a surface of a levelled cloud is level: it looks alike
/// everywhere.
inline constexpr float kLevel = 0.8f;

/// Whether a point of a levelled cloud has a normal, and its surface stands up.
inline bool is_steep(const PointCloud& cloud, std::size_t i) {
  return std::abs(cloud.nz[i]) < kLevel && cloud.normal(i).squaredNorm() > 0.5f;
}

/// The unit normal of each point from the neighbours within `radius` metres, looking towards the
/// sensor that saw it; zero where there are fewer than five or they span no plane. Normals that the cloud
/// brings are made unit and kept.
void add_normals(PointCloud* cloud, float radius);

}  // namespace scanlock
