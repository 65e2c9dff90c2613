// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// The variants of PointCloud2: the same cloud with the members in different order.
#include <cstdint>

#include "messages/packed_cloud.hpp"
#include "messages/scan_types.hpp"

namespace scanlock {
namespace {

constexpr std::size_t kMinFieldBytes = 4 + 1 + 4 + 1 + 4;  // empty name, offset, datatype, count

void read_fields(ByteReader& reader, std::size_t count, PackedCloud& cloud) {
  for (std::size_t i = 0; i < count && reader.ok(); ++i) {
    const std::string_view name = reader.read_string("fields.name");
    const std::int32_t offset = reader.read_i32("fields.offset");
    const int datatype = reader.read_i8("fields.datatype");
    reader.read_i32("fields.count");  // not needed: a coordinate is the first value of its field
    if (reader.ok()) cloud.consider_field(name, offset, datatype);
  }
}

}  // namespace

void decode_pointcloud2(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded) {
  PackedCloud cloud;
  decoded.scan.utime = reader.read_i64("utime");
  decoded.seq = reader.read_i32("seq");
  decoded.frame_id = reader.read_string("frame_id");
  cloud.height = reader.read_i32("height");
  cloud.width = reader.read_i32("width");
  const std::size_t field_count = reader.read_count_i32("nfields", kMinFieldBytes);
  read_fields(reader, field_count, cloud);
  cloud.big_endian = reader.read_u8("is_bigendian") != 0;
  cloud.point_step = reader.read_i32("point_step");
  cloud.row_step = reader.read_i32("row_step");
  const std::size_t data_bytes = reader.read_count_i32("data_nbytes", 1);
  cloud.data = reader.read_bytes(data_bytes, "data");
  reader.read_u8("is_dense");  // ignored: every point is checked
  reader.expect_end();
  unpack(cloud, limits, reader, decoded);
}

void decode_ros_pointcloud2(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded) {
  PackedCloud cloud;
  const std::size_t field_count = reader.read_count_i32("fields_length", kMinFieldBytes);
  const std::size_t data_bytes = reader.read_count_i32("data_length", 1);
  decoded.seq = reader.read_i32("header.seq");
  const std::int64_t seconds = reader.read_i32("header.stamp.sec");
  const std::int64_t nanoseconds = reader.read_i32("header.stamp.nsec");
  decoded.scan.utime = seconds * 1000000 + nanoseconds / 1000;
  decoded.frame_id = reader.read_string("header.frame_id");
  cloud.height = reader.read_i32("height");
  cloud.width = reader.read_i32("width");
  read_fields(reader, field_count, cloud);
  cloud.big_endian = reader.read_u8("is_bigendian") != 0;
  cloud.point_step = reader.read_i32("point_step");
  cloud.row_step = reader.read_i32("row_step");
  cloud.data = reader.read_bytes(data_bytes, "data");
  reader.read_u8("is_dense");
  reader.expect_end();
  unpack(cloud, limits, reader, decoded);
}

void decode_drake_point_cloud(ByteReader& reader, const DecodeLimits& limits, DecodedScan& decoded) {
  constexpr std::int64_t kBigEndianFlag = 1;
  PackedCloud cloud;
  decoded.scan.utime = reader.read_i64("utime");
  decoded.frame_id = reader.read_string("frame_name");
  cloud.width = reader.read_i64("width");
  cloud.height = reader.read_i64("height");
  const std::size_t field_count = reader.read_count_i32("num_fields", kMinFieldBytes);
  read_fields(reader, field_count, cloud);
  cloud.big_endian = (reader.read_i64("flags") & kBigEndianFlag) != 0;
  cloud.point_step = reader.read_i32("point_step");
  cloud.row_step = reader.read_i64("row_step");
  const std::size_t filler_bytes = reader.read_count_i16("filler_size", 1);
  reader.read_bytes(filler_bytes, "filler");
  const std::size_t data_bytes = reader.read_count_i64("data_size", 1);
  cloud.data = reader.read_bytes(data_bytes, "data");
  reader.expect_end();
  unpack(cloud, limits, reader, decoded);
}

}  // namespace scanlock
