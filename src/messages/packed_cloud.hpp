// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "messages/byte_reader.hpp"
#include "messages/decode_scan.hpp"

namespace scanlock {

/// Position and type of one value within a point; `datatype` is numbered as in ROS, Drake and bot_core.
struct PackedField {
  std::string name;
  std::int64_t offset = 0;  ///< bytes from the start of the point
  int datatype = 0;         ///< 1 int8, 2 uint8, 3 int16, 4 uint16, 5 int32, 6 uint32, 7 float32, 8 float64
  int rank = 0;             ///< of the name: 0 is preferred
};

inline constexpr std::int8_t kFloat32Datatype = 7, kFloat64Datatype = 8;

/// Bytes of a value; 0 for an undefined datatype.
std::size_t datatype_size(int datatype);

/// The layout that all variants of PointCloud2 share: points of `point_step` bytes in rows of `row_step`
/// bytes. The members hold what the message contains, unchecked; unpack() checks them.
struct PackedCloud {
  std::int64_t width = 0, height = 0;
  std::int64_t point_step = 0, row_step = 0;
  bool big_endian = false;
  ByteView data;
  std::optional<PackedField> x, y, z, intensity, time;
  std::string names;  ///< of the fields, for error messages; the first ones where there are many

  /// Stores the field if it can serve as one of x, y, z, intensity and time. Of several candidates, the one
  /// with the best rank is kept; of equal ranks, the first.
  void consider_field(std::string_view name, std::int64_t offset, int datatype);
};

/// Checks the layout and unpacks the points into `decoded.scan`, whose utime must be set; otherwise records a
/// fault in the reader.
void unpack(const PackedCloud& cloud, const DecodeLimits& limits, ByteReader& reader, DecodedScan& decoded);

}  // namespace scanlock
