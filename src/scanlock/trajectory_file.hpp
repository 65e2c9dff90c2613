// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component files: trajectories in the formats of TUM and KITTI.
#pragma once

#include "io/trajectory.hpp"
#include "scanlock/pose.hpp"
