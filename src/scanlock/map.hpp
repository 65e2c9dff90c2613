// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component core: maps to be loaded into a Mapper, out of clouds, and clouds out of maps.
#pragma once

#include "mapping/cloud_map.hpp"
#include "scanlock/cloud.hpp"
#include "scanlock/pose.hpp"
