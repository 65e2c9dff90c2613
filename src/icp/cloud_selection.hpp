// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Every n-th point, n chosen such that about `count` points are left.
PointCloud thinned(const PointCloud& points, std::size_t count);

/// The n points in an order in which, for every k, the first n / 2^k of them are spread over the whole cloud.
/// Each level keeps the order of the input, so that neighbours stay together.
PointCloud in_level_order(const PointCloud& points);

/// The smallest number n / 2^k that is at least `wanted`, for in_level_order(); n where more are wanted.
std::size_t level_points(std::size_t n, double wanted);

/// Points that are about equally far apart, about `count` to twice as many if the cloud has as many;
/// `diagonal`: of the cloud, metres. Without normals.
PointCloud spread_out(const PointCloud& points, double diagonal, std::size_t count);

}  // namespace scanlock
