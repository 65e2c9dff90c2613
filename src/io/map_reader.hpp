// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "io/byte_source.hpp"
#include "odometry/keyframe_archive.hpp"

namespace scanlock {

/// In one pass. Of a damaged file the checksum is what is wrong, whatever else seems to be. Throws
/// std::runtime_error, see decode_map() of map_file.hpp.
SavedMap decode_map(ByteSource& source, const std::string& name);

}  // namespace scanlock
