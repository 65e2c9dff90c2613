// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component files: clouds in .bin (KITTI), .ply, .pcd, .xyz and .txt.
#pragma once

#include "io/cloud_file.hpp"
#include "scanlock/cloud.hpp"
