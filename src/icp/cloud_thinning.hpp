// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// A voxel size, metres, that leaves about ten thousand points of the cloud, which is plenty to align it; 0
/// (keep all) for a cloud that has not many more.
double sensible_voxel(const PointCloud& cloud);

/// thin_by_voxel(), selected; the cloud itself for a voxel of 0.
PointCloud thinned_by(const PointCloud& cloud, double voxel);

}  // namespace scanlock
