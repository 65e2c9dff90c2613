// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// Tests that a decoder returns a value for any bytes. Most errors of this kind show only under the
// sanitizers, with which tools/check runs this file, too.
#include <doctest/doctest.h>

#include <cmath>
#include <mbot_lcm_msgs/lidar_t.hpp>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "messages/decode_report.hpp"
#include "messages/encode_scan.hpp"
#include "messages/generated_bytes.hpp"
#include "messages/sector_assembler.hpp"
#include "sample_reports.hpp"
#include "sample_scan.hpp"

using namespace scanlock;

namespace {

Bytes mbot_message() {
  mbot_lcm_msgs::lidar_t message{};
  message.utime = 1700000000000000;
  message.num_ranges = 7;
  message.ranges.assign(7, 2.5f);
  message.thetas.assign(7, 0.5f);
  message.times.assign(7, 1700000000000000);
  message.intensities.assign(7, 1.0f);
  return generated_bytes(message);
}

std::vector<Bytes> scans() {
  const Scan scan = sample_scan(7);
  return {encode_pointcloud2(scan),
          encode_ros_pointcloud2(scan),
          encode_drake_point_cloud(scan),
          encode_pointcloud(scan),
          encode_planar_lidar(scan, 16),
          encode_sectors(scan).front(),
          mbot_message()};
}

std::vector<Bytes> reports() {
  const TrackedScan tracked = sample_tracked();
  return {encode_pose(tracked, TwistFrame::kLocal),
          encode_rigid_transform(tracked),
          encode_pose2d(tracked),
          encode_nav_odometry(tracked, "map", "body", 1),
          encode_odometry(tracked, sample_context()),
          encode_status(sample_status()),
          encode_recovery(sample_recovery()),
          encode_command(Command{})};
}

/// Decodes a copy that ends exactly where the message does, so that a sanitizer finds reads beyond its end.
template <typename Decode>
auto decode_tight(const Bytes& bytes, std::size_t size, Decode decode) {
  const std::unique_ptr<std::uint8_t[]> copy(new std::uint8_t[size]);
  std::copy(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size), copy.get());
  return decode(copy.get(), size);
}

/// Checks that must hold for every decoded scan, whatever the bytes.
void check_sound(const DecodedScan& decoded, std::size_t message_bytes) {
  const PointCloud& points = decoded.scan.points;
  const bool sound_sizes = points.y.size() == points.size() && points.z.size() == points.size() &&
                           (points.time.empty() || points.time.size() == points.size()) &&
                           (points.intensity.empty() || points.intensity.size() == points.size());
  REQUIRE(sound_sizes);
  REQUIRE(points.size() * 2 <= message_bytes);
  REQUIRE((decoded.fault == DecodeFault::kNone) == decoded.error.empty());
  if (decoded.fault != DecodeFault::kNone) REQUIRE(points.empty());
  bool finite = true;
  for (std::size_t i = 0; i < points.size(); ++i) finite = finite && points.point(i).allFinite();
  for (const float time : points.time) finite = finite && std::isfinite(time);
  for (const float intensity : points.intensity) finite = finite && std::isfinite(intensity);
  REQUIRE(finite);
}

void decode_as_everything(const std::uint8_t* data, std::size_t size) {
  check_sound(decode_scan(data, size), size);
  const auto pose = decode_pose(data, size);
  REQUIRE(pose.ok() == pose.error.empty());
  if (pose.ok()) REQUIRE(pose.value.map_from_body.matrix().allFinite());
  const auto odometry = decode_odometry(data, size);
  REQUIRE(odometry.ok() == odometry.error.empty());
  REQUIRE(decode_status(data, size).ok() == decode_status(data, size).error.empty());
  REQUIRE(decode_recovery(data, size).ok() == decode_recovery(data, size).error.empty());
  REQUIRE(decode_command(data, size).ok() == decode_command(data, size).error.empty());
  REQUIRE(decode_attitude(data, size).ok() == decode_attitude(data, size).error.empty());
}

}  // namespace

TEST_CASE("every shorter length of every scan is truncated, and so is one byte more") {
  for (const Bytes& bytes : scans()) {
    const auto decode = [](const std::uint8_t* data, std::size_t size) { return decode_scan(data, size); };
    const DecodedScan whole = decode_tight(bytes, bytes.size(), decode);
    CAPTURE(whole.type);
    REQUIRE(whole.error == "");
    CHECK_FALSE(whole.scan.points.empty());
    for (std::size_t size = 0; size < bytes.size(); ++size)
      REQUIRE(decode_tight(bytes, size, decode).fault == DecodeFault::kTruncated);
    Bytes longer = bytes;
    longer.push_back(0);
    CHECK(decode_tight(longer, longer.size(), decode).fault == DecodeFault::kTruncated);
  }
}

TEST_CASE("every shorter length of every report is a fault") {
  for (const Bytes& bytes : reports())
    for (std::size_t size = 0; size < bytes.size(); ++size)
      decode_tight(bytes, size, [](const std::uint8_t* data, std::size_t given) {
        REQUIRE_FALSE(decode_pose(data, given).ok());
        REQUIRE_FALSE(decode_odometry(data, given).ok());
        REQUIRE_FALSE(decode_status(data, given).ok());
        REQUIRE_FALSE(decode_recovery(data, given).ok());
        REQUIRE_FALSE(decode_command(data, given).ok());
        return 0;
      });
}

TEST_CASE("extreme numbers at every offset of every message") {
  const std::uint32_t numbers[] = {0xffffffff, 0x80000000, 0x7fffffff, 0x40000000, 0x10000000, 0x00010000,
                                   0,          1,          0x7fc00000, 0x7f800000, 0x3fffffff, 0x55555556};
  std::vector<Bytes> messages = scans();
  for (Bytes& bytes : reports()) messages.push_back(std::move(bytes));
  for (const Bytes& bytes : messages)
    for (std::size_t at = 8; at + 4 <= bytes.size(); ++at)
      for (const std::uint32_t number : numbers) {
        Bytes evil = bytes;
        for (std::size_t i = 0; i < 4; ++i) evil[at + i] = static_cast<std::uint8_t>(number >> (24 - 8 * i));
        decode_tight(evil, evil.size(), [](const std::uint8_t* data, std::size_t size) {
          decode_as_everything(data, size);
          return 0;
        });
      }
}

TEST_CASE("random mutations of every message") {
  std::mt19937 random(20260101);
  const auto below = [&](std::size_t limit) { return static_cast<std::size_t>(random() % limit); };
  std::vector<Bytes> messages = scans();
  for (Bytes& bytes : reports()) messages.push_back(std::move(bytes));
  SectorAssembler assembler(1000);
  for (int round = 0; round < 60000; ++round) {
    Bytes bytes = messages[below(messages.size())];
    for (std::size_t count = 1 + below(4); count > 0; --count) {
      const std::size_t at = 8 + below(bytes.size() - 8);
      switch (below(3)) {
        case 0:
          bytes[at] = static_cast<std::uint8_t>(random());
          break;
        case 1:
          bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ 1u << below(8));
          break;
        default:
          bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at));
          break;
      }
      if (bytes.size() < 16) break;
    }
    decode_tight(bytes, bytes.size(), [&](const std::uint8_t* data, std::size_t size) {
      decode_as_everything(data, size);
      for (const DecodedScan& scan : assembler.add(decode_scan(data, size))) check_sound(scan, 1000 * size);
      return 0;
    });
  }
}

TEST_CASE("the messages that are known to kill a generated decoder") {
  // Thirty bytes with a count of about 2^31 elements, or a negative count (notes on LCM, section 4).
  for (const std::uint8_t top : std::initializer_list<std::uint8_t>{0x7f, 0x80, 0xff, 0x40}) {
    Bytes planar = encode_planar_lidar(sample_scan(1), 1);
    planar[16] = top;  // nranges
    planar[17] = planar[18] = planar[19] = 0xff;
    const DecodedScan decoded = decode_scan(planar.data(), planar.size());
    CHECK(decoded.fault != DecodeFault::kNone);
    CHECK(decoded.error.find("`nranges`") != std::string::npos);

    Bytes cloud = encode_pointcloud2(sample_scan(1), {0, ""});
    cloud[20] = top;  // length of frame_id
    cloud[21] = cloud[22] = cloud[23] = 0xff;
    const DecodedScan unterminated = decode_scan(cloud.data(), cloud.size());
    CHECK(unterminated.fault != DecodeFault::kNone);
    CHECK(unterminated.error.find("`frame_id`") != std::string::npos);
  }
  Bytes cloud = encode_pointcloud2(sample_scan(1), {0, ""});
  cloud[23] = 0;  // a string without its final zero
  CHECK(decode_scan(cloud.data(), cloud.size()).fault == DecodeFault::kBadSize);
}
