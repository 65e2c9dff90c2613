// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "io/byte_source.hpp"
#include "odometry/keyframe_archive.hpp"

namespace scanlock {

/// Decodes a map in one pass. When the body cannot be decoded and the checksum does not match either, the
/// checksum is the error reported. Throws std::runtime_error, see decode_map() in map_file.hpp.
SavedMap decode_map(ByteSource& source, const std::string& name);

}  // namespace scanlock
