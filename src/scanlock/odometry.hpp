// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component core: LiDAR odometry with relocalisation and loop closure. Mapper takes scans and returns poses;
// MapWorker executes Mapper's requests, between two scans or in a thread of its own.
#pragma once

#include "mapping/mapper.hpp"
#include "scanlock/cloud.hpp"
#include "scanlock/pose.hpp"
