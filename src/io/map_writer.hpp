// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "io/atomic_file.hpp"
#include "odometry/keyframe_archive.hpp"

namespace scanlock {

/// Passes the bytes of a map file on piece by piece. Points that are not finite are left out. Throws
/// PointsUnreadable.
void encode_map(const SavedMap& map, const TakeBytes& take);

}  // namespace scanlock
