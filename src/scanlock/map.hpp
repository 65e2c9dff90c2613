// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component core: makes maps for a Mapper from clouds, and clouds from maps.
#pragma once

#include "mapping/cloud_map.hpp"
#include "scanlock/cloud.hpp"
#include "scanlock/pose.hpp"
