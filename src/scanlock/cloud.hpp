// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component core: points, scans, and their preparation before an alignment.
#pragma once

#include "geometry/moved_cloud.hpp"
#include "geometry/point_cloud.hpp"
#include "geometry/voxel_grid.hpp"
#include "icp/cloud_thinning.hpp"
#include "scanlock/version.hpp"
