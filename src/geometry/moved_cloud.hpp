// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"

namespace scanlock {

/// The cloud in the frame that the pose leads to: points moved, normals turned, the rest as it is.
PointCloud moved(PointCloud cloud, const Pose& pose);

}  // namespace scanlock
