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

/// Where a value of a point lies and what it is; the numbers of `datatype` are those of ROS, Drake and
/// bot_core.
struct PackedField {
  std::string name;
  std::int64_t offset = 0;  ///< bytes from the start of the point
  int datatype = 0;         ///< 1 int8, 2 uint8, 3 int16, 4 uint16, 5 int32, 6 uint32, 7 float32, 8 float64
  int rank = 0;             ///< of the name, 0 is the best
};

inline constexpr std::int8_t kFloat32Datatype = 7, kFloat64Datatype = 8;

/// Bytes of a value; 0 for a datatype that does not exist.
std::size_t datatype_size(int datatype);

/// A cloud as all relatives of PointCloud2 carry it: points of `point_step` bytes in rows of `row_step`
/// bytes. Holds whatever the message says; `unpack` judges it.
struct PackedCloud {
  std::int64_t width = 0, height = 0;
  std::int64_t point_step = 0, row_step = 0;
  bool big_endian = false;
  ByteView data;
  std::optional<PackedField> x, y, z, intensity, time;

  /// Remembers the field if it is one of those above; of several that could serve, the best name, then the
  /// first.
  void consider_field(std::string_view name, std::int64_t offset, int datatype);
};

/// Checks the layout and unpacks it into `decoded.scan` (whose utime must be set), or notes a fault at the
/// reader.
void unpack(const PackedCloud& cloud, const DecodeLimits& limits, ByteReader& reader, DecodedScan& decoded);

}  // namespace scanlock
