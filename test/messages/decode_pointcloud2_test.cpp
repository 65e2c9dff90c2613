// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <bot_core/pointcloud2_t.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "messages/decode_scan.hpp"
#include "messages/encode_scan.hpp"
#include "messages/generated_bytes.hpp"
#include "sample_scan.hpp"
#include "wire.hpp"

using namespace scanlock;

namespace {

/// Builds packed points value by value, in either byte order.
struct Packer {
  bool big_endian = false;
  std::vector<std::uint8_t> data;

  template <typename Value>
  void put(Value value) {
    std::uint8_t bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);  // the tests run on little-endian machines
    for (std::size_t i = 0; i < sizeof value; ++i)
      data.push_back(bytes[big_endian ? sizeof value - 1 - i : i]);
  }
};

bot_core::pointcloud2_t cloud_of(const std::vector<std::uint8_t>& data, int width, int point_step) {
  bot_core::pointcloud2_t message{};
  message.utime = 1700000000000000;
  message.seq = 3;
  message.frame_id = "velodyne";
  message.height = 1;
  message.width = width;
  message.point_step = point_step;
  message.row_step = width * point_step;
  message.data = data;
  message.data_nbytes = static_cast<std::int32_t>(data.size());
  return message;
}

void add_field(bot_core::pointcloud2_t& message, const std::string& name, int offset, int datatype) {
  bot_core::pointfield_t field{};
  field.name = name;
  field.offset = offset;
  field.datatype = static_cast<std::int8_t>(datatype);
  field.count = 1;
  message.fields.push_back(field);
  message.nfields = static_cast<std::int32_t>(message.fields.size());
}

/// Two valid points, x y z float32 in 12 bytes.
bot_core::pointcloud2_t two_points() {
  Packer packer;
  for (const float value : {1.0f, 2.0f, 3.0f, -4.0f, 5.5f, 6.0f}) packer.put(value);
  auto message = cloud_of(packer.data, 2, 12);
  add_field(message, "x", 0, 7);
  add_field(message, "y", 4, 7);
  add_field(message, "z", 8, 7);
  return message;
}

}  // namespace

TEST_CASE("pointcloud2 of two points") {
  const DecodedScan decoded = decode(two_points());
  REQUIRE(decoded.error == "");
  CHECK(decoded.type == "bot_core.pointcloud2_t");
  CHECK(decoded.seq == 3);
  CHECK(decoded.frame_id == "velodyne");
  CHECK(decoded.scan.utime == 1700000000000000);
  CHECK(decoded.scan.points.x == std::vector<float>{1, -4});
  CHECK(decoded.scan.points.y == std::vector<float>{2, 5.5});
  CHECK(decoded.scan.points.z == std::vector<float>{3, 6});
  CHECK_FALSE(decoded.scan.points.has_times());
  CHECK_FALSE(decoded.scan.points.has_intensity());
}

TEST_CASE("pointcloud2 in any order with padding, doubles, either byte order, padded rows") {
  for (const bool big_endian : {false, true}) {
    CAPTURE(big_endian);
    Packer packer{big_endian, {}};
    for (int row = 0; row < 2; ++row) {
      for (int column = 0; column < 2; ++column) {
        packer.put(std::uint16_t{0xffff});    // an unknown field
        packer.put(10.0 * row + column);      // z
        packer.put(std::uint8_t{200});        // intensity
        packer.put(std::uint32_t{50000000});  // t
        packer.put(1.5);                      // x
        packer.put(-2.5);                     // y
      }
      for (int i = 0; i < 5; ++i) packer.put(std::uint8_t{0xee});
    }
    auto message = cloud_of(packer.data, 2, 31);
    message.height = 2;
    message.row_step = 2 * 31 + 5;
    message.is_bigendian = big_endian ? 1 : 0;
    add_field(message, "ring", 0, 4);
    add_field(message, "y", 23, 8);
    add_field(message, "x", 15, 8);
    add_field(message, "t", 11, 6);
    add_field(message, "intensity", 10, 2);
    add_field(message, "z", 2, 8);
    const DecodedScan decoded = decode(message);
    REQUIRE(decoded.error == "");
    CHECK(decoded.scan.points.x == std::vector<float>(4, 1.5f));
    CHECK(decoded.scan.points.y == std::vector<float>(4, -2.5f));
    CHECK(decoded.scan.points.z == std::vector<float>{0, 1, 10, 11});
    CHECK(decoded.scan.points.intensity == std::vector<float>(4, 200.0f));
    REQUIRE(decoded.scan.points.has_times());
    CHECK(decoded.scan.points.time[3] == doctest::Approx(0.05));
  }
}

TEST_CASE("points that are not finite or exactly the origin are left out and counted") {
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  Packer packer;
  for (const float value : {nan, 2.0f, 3.0f, 1.0f, infinity, 3.0f, 0.0f, 0.0f, 0.0f, 7.0f, 0.0f, 0.0f})
    packer.put(value);
  auto message = cloud_of(packer.data, 4, 12);
  add_field(message, "x", 0, 7);
  add_field(message, "y", 4, 7);
  add_field(message, "z", 8, 7);
  const DecodedScan decoded = decode(message);
  REQUIRE(decoded.error == "");
  CHECK(decoded.scan.points.x == std::vector<float>{7});
  CHECK(decoded.nonfinite_points == 3);
}

TEST_CASE("a scan without points is no fault") {
  const Bytes bytes = encode_pointcloud2(Scan{});
  const DecodedScan decoded = decode_scan(bytes.data(), bytes.size());
  CHECK(decoded.error == "");
  CHECK(decoded.scan.points.empty());
}

TEST_CASE("the utime is passed through as given") {
  auto message = two_points();
  message.utime = -5;
  CHECK(decode(message).scan.utime == -5);
  message.utime = 0;
  CHECK(decode(message).scan.utime == 0);
}

TEST_CASE("each wrong member of a pointcloud2 is a fault that names it") {
  struct Case {
    const char* word;
    DecodeFault fault;
    void (*spoil)(bot_core::pointcloud2_t&);
  };
  const Case cases[] = {
      {"width", DecodeFault::kBadSize, [](auto& m) { m.width = -1; }},
      {"height", DecodeFault::kBadSize, [](auto& m) { m.height = -1; }},
      {"width", DecodeFault::kBadSize, [](auto& m) { m.width = 0x7fffffff; }},
      {"height", DecodeFault::kBadSize, [](auto& m) { m.width = m.height = 0x7fffffff; }},
      {"data bytes", DecodeFault::kBadSize, [](auto& m) { m.width = 0; }},
      {"data bytes", DecodeFault::kBadSize, [](auto& m) { m.width = 1; }},
      {"row_step", DecodeFault::kBadSize, [](auto& m) { m.width = 3; }},
      {"data bytes", DecodeFault::kBadSize, [](auto& m) { m.height = 2; }},
      {"row_step", DecodeFault::kBadSize,
       [](auto& m) {
         m.height = 2;
         m.row_step = -24;
       }},
      {"row_step", DecodeFault::kBadSize,
       [](auto& m) {
         m.height = 2;
         m.row_step = 0x7fffffff;
       }},
      {"point_step", DecodeFault::kBadSize, [](auto& m) { m.point_step = 0; }},
      {"point_step", DecodeFault::kBadSize, [](auto& m) { m.point_step = -12; }},
      {"point_step", DecodeFault::kBadSize, [](auto& m) { m.point_step = 0x7fffffff; }},
      {"`x` lies outside", DecodeFault::kBadField, [](auto& m) { m.fields[0].offset = -1; }},
      {"`y` lies outside", DecodeFault::kBadField, [](auto& m) { m.fields[1].offset = 9; }},
      {"`z` lies outside", DecodeFault::kBadField, [](auto& m) { m.fields[2].offset = 0x7fffffff; }},
      {"no field `x` among `u`, `y`, `z`", DecodeFault::kBadField, [](auto& m) { m.fields[0].name = "u"; }},
      {"`x` has datatype 5", DecodeFault::kBadField, [](auto& m) { m.fields[0].datatype = 5; }},
      {"`y` has datatype 99", DecodeFault::kBadField, [](auto& m) { m.fields[1].datatype = 99; }},
      {"`t` lies outside", DecodeFault::kBadField, [](auto& m) { add_field(m, "t", 12, 7); }},
      {"`intensity` has the unknown", DecodeFault::kBadField,
       [](auto& m) { add_field(m, "intensity", 0, -7); }},
  };
  for (const Case& spoilt : cases) {
    auto message = two_points();
    spoilt.spoil(message);
    const DecodedScan decoded = decode(message);
    CAPTURE(decoded.error);
    CHECK(decoded.fault == spoilt.fault);
    CHECK(decoded.error.find(spoilt.word) != std::string::npos);
    CHECK(decoded.error.find("bot_core.pointcloud2_t: ") == 0);
    CHECK(decoded.scan.points.empty());
  }
}

TEST_CASE("short, long, too large and unknown messages are faults") {
  Bytes bytes = generated_bytes(two_points());
  CHECK(decode_scan(nullptr, 0).fault == DecodeFault::kTruncated);
  CHECK(decode_scan(bytes.data(), 7).fault == DecodeFault::kTruncated);
  DecodeLimits small;
  small.max_message_bytes = 40;
  CHECK(decode_scan(bytes.data(), bytes.size(), small).fault == DecodeFault::kBadSize);
  small = {};
  small.max_points = 1;
  CHECK(decode_scan(bytes.data(), bytes.size(), small).fault == DecodeFault::kBadSize);
  bytes.push_back(0);
  CHECK(decode_scan(bytes.data(), bytes.size()).fault == DecodeFault::kTruncated);
  bytes[0] ^= 1;
  const DecodedScan unknown = decode_scan(bytes.data(), bytes.size());
  CHECK(unknown.fault == DecodeFault::kUnknownType);
  CHECK(unknown.error.find("0acd5ce4bf5a1b4a") != std::string::npos);
}

TEST_CASE("an encoded pointcloud2 is decoded bit for bit, and by the generated decoder") {
  const Scan scan = sample_scan(1000);
  const Bytes bytes = encode_pointcloud2(scan, {7, "lidar"});
  const DecodedScan decoded = decode_scan(bytes.data(), bytes.size());
  REQUIRE(decoded.error == "");
  CHECK(decoded.scan.utime == scan.utime);
  CHECK(decoded.seq == 7);
  CHECK(decoded.frame_id == "lidar");
  CHECK(decoded.scan.points.x == scan.points.x);
  CHECK(decoded.scan.points.y == scan.points.y);
  CHECK(decoded.scan.points.z == scan.points.z);
  CHECK(decoded.scan.points.intensity == scan.points.intensity);
  CHECK(decoded.scan.points.time == scan.points.time);

  bot_core::pointcloud2_t theirs;
  REQUIRE(theirs.decode(bytes.data(), 0, static_cast<int>(bytes.size())) == static_cast<int>(bytes.size()));
  CHECK(theirs.width == 1000);
  CHECK(theirs.data_nbytes == 20000);
}
