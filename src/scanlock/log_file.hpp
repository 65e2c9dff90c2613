// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component files: reading and writing LCM logs event by event, without an LCM library.
#pragma once

#include "io/lcm_log.hpp"
#include "scanlock/version.hpp"
