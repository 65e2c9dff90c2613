// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// What can be wrong with a message that should hold a scan.
enum class DecodeFault : std::int8_t {
  kNone = 0,
  kTruncated,    ///< it ends before its own sizes say so, or goes on after
  kUnknownType,  ///< the fingerprint is of no type that we accept
  kBadSize,      ///< a negative size, one over the limits, or sizes that contradict each other
  kBadField,     ///< no usable x, y, z: missing, of another type, or outside the point
};
const char* to_string(DecodeFault fault);

struct DecodeLimits {
  std::size_t max_message_bytes = 64u << 20;
  std::size_t max_points = 2000000;
};

struct DecodedScan {
  DecodeFault fault = DecodeFault::kNone;
  std::string error;  ///< a sentence that names the member at fault; empty without fault
  std::string type;   ///< for instance "bot_core.pointcloud2_t"
  Scan scan;          ///< only finite points; empty with a fault
  std::size_t nonfinite_points = 0;  ///< left out: NaN or infinite (the usual "no return"), or exactly 0 0 0
};

/// Decodes any accepted scan type, told apart by its fingerprint (the first eight bytes, big endian).
/// Never throws, never allocates more than the message justifies: every size is checked against the bytes
/// that are there before anything is allocated for it.
DecodedScan decode_scan(const std::uint8_t* data, std::size_t size, const DecodeLimits& limits = {});

}  // namespace scanlock
