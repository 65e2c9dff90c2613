// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// A voxel size, metres, for aligning the cloud: a small share of the scene's size, finer where that would
/// leave less than 18 % of the points (24,000 are always enough), coarser where it would leave more than
/// 30,000; 0 (keep all) for clouds of at most 20,000 points.
double sensible_voxel(const PointCloud& cloud);

/// average_by_voxel() of the cloud; the cloud itself for a voxel of 0 metres.
PointCloud thinned_by(const PointCloud& cloud, double voxel);

}  // namespace scanlock
