// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Component core: alignment of two clouds from an initial pose by the methods of "Fast and Robust Iterative
// Closest Point": align_clouds().
#pragma once

#include "icp/cloud_alignment.hpp"
#include "icp/cloud_chain.hpp"
#include "icp/cloud_target.hpp"
#include "scanlock/cloud.hpp"
#include "scanlock/pose.hpp"
