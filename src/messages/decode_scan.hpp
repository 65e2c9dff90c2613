// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Errors in a message that should hold a scan.
enum class DecodeFault : std::int8_t {
  kNone = 0,
  kTruncated,    ///< shorter, or longer, than its own sizes require
  kUnknownType,  ///< the fingerprint is not of an accepted type
  kBadSize,      ///< a size is negative, above the limits, or contradicts another size
  kBadField,     ///< x, y or z is missing, of another type or outside the point; or a value is out of range
};
const char* to_string(DecodeFault fault);

struct DecodeLimits {
  std::size_t max_message_bytes = 64u << 20;
  std::size_t max_points = 2000000;
  /// mbot_lcm_msgs.lidar_t: drivers exist for either direction. False: thetas grow counter-clockwise, seen
  /// from above.
  bool mbot_clockwise = false;
  /// Metres: ranges from here on are no returns. A planar scanner without a return reports the largest range
  /// that it can encode (SICK 81.83 to 81.91, Hokuyo 60 or 65.53).
  double planar_no_return_m = 50;
};

struct DecodedScan {
  DecodeFault fault = DecodeFault::kNone;
  std::string error;  ///< a sentence that names the member at fault; empty without fault
  std::string type;   ///< for instance "bot_core.pointcloud2_t"
  Scan scan;          ///< only finite points; empty with a fault. utime as received, even if 0 or negative
  std::size_t nonfinite_points = 0;  ///< omitted: NaN or infinite (the usual "no return"), or exactly 0 0 0

  std::int32_t seq = 0;    ///< the sender's sequence number, 0 where the type has none
  std::string frame_id;    ///< empty where the type has none
  std::string time_field;  ///< how times of points were interpreted, or why they were ignored, for the user
  int sector_index = 0;    ///< of scan_sector_t: index of this sector, from 0; see sector_assembler.hpp
  int sector_count = 1;
  bool is_sector() const { return type == "scanlock.scan_sector_t"; }
  std::size_t sectors_missing = 0;  ///< set by SectorAssembler: sectors that did not arrive
};

/// Decodes any accepted scan type, identified by its fingerprint (the first eight bytes, big endian). Throws
/// only when memory runs out, and never allocates more than a small multiple of the size of the message:
/// every size is checked against the bytes that are left before memory is allocated for it.
DecodedScan decode_scan(const std::uint8_t* data, std::size_t size, const DecodeLimits& limits = {});

}  // namespace scanlock
