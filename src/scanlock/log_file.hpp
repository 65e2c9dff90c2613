// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component files: LCM logs, event by event, without a library of LCM.
#pragma once

#include "io/lcm_log.hpp"
#include "scanlock/version.hpp"
