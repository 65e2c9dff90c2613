// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Every n-th point, so that about `count` are left.
PointCloud thinned(const PointCloud& points, std::size_t count);

/// Points in an order in which the first n / 2^k of them are spread over the whole cloud, for every k, and
/// neighbours stay together within each such part.
PointCloud in_level_order(const PointCloud& points);

/// The n / 2^k of those, as few as possible but at least `wanted`; all n where more are wanted.
std::size_t level_points(std::size_t n, double wanted);

/// Points about equally far apart, `count` to twice as many where there are so many; `diagonal` of the cloud,
/// metres.
PointCloud spread_out(const PointCloud& points, double diagonal, std::size_t count);

}  // namespace scanlock
