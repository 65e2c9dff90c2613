// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component core: registration without an initial pose, with a certificate: register_raw_clouds() for two
// levelled clouds, register_matches() for given matches.
#pragma once

#include "global/cloud_registration.hpp"
#include "global/max_consensus.hpp"
#include "scanlock/cloud.hpp"
#include "scanlock/pose.hpp"
