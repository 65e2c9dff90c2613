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
  kBadField,  ///< no usable x, y, z: missing, of another type, or outside the point; or a value that makes no
              ///< sense
};
const char* to_string(DecodeFault fault);

struct DecodeLimits {
  std::size_t max_message_bytes = 64u << 20;
  std::size_t max_points = 2000000;
  /// mbot_lcm_msgs.lidar_t: drivers of both senses exist. False: thetas grow counter-clockwise seen from
  /// above.
  bool mbot_clockwise = false;
  /// Metres: a planar scanner that saw nothing says a range from here on, the largest number that it has
  /// (SICK 81.83 to 81.91, Hokuyo 60 or 65.53).
  double planar_no_return_m = 50;
};

struct DecodedScan {
  DecodeFault fault = DecodeFault::kNone;
  std::string error;  ///< a sentence that names the member at fault; empty without fault
  std::string type;   ///< for instance "bot_core.pointcloud2_t"
  Scan scan;  ///< only finite points; empty with a fault. utime is as given, even where it is 0 or negative
  std::size_t nonfinite_points = 0;  ///< left out: NaN or infinite (the usual "no return"), or exactly 0 0 0

  std::int32_t seq = 0;  ///< the sender's own count, 0 where the type has none
  std::string frame_id;  ///< empty where the type has none
  std::string
      time_field;  ///< how the times of points were understood, or why they were not; for a person to read
  int sector_index = 0;  ///< scan_sector_t: this is one slice of `sector_count`; see sector_assembler.hpp
  int sector_count = 1;
  bool is_sector() const { return type == "scanlock.scan_sector_t"; }
  std::size_t sectors_missing = 0;  ///< set by SectorAssembler: slices that never came
};

/// Decodes any accepted scan type, told apart by its fingerprint (the first eight bytes, big endian).
/// Never throws but for lack of memory, never allocates more than a small multiple of the message: every size
/// is checked against the bytes that are there before anything is allocated for it.
DecodedScan decode_scan(const std::uint8_t* data, std::size_t size, const DecodeLimits& limits = {});

}  // namespace scanlock
