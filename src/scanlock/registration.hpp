// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component core: registration without a start, with its certificate: register_raw_clouds() of two levelled
// clouds, register_matches() of matches.
#pragma once

#include "global/cloud_registration.hpp"
#include "global/max_consensus.hpp"
#include "scanlock/cloud.hpp"
#include "scanlock/pose.hpp"
