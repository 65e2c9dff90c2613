// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"

namespace scanlock {

/// The cloud transformed by the pose: points and sensor origins (`eyes`) moved, normals rotated, all other
/// attributes unchanged.
PointCloud moved(PointCloud cloud, const Pose& pose);

}  // namespace scanlock
