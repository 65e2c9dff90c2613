// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pointcloud_t.hpp>
#include <cmath>
#include <drake/lcmt_point_cloud.hpp>
#include <limits>
#include <mbot_lcm_msgs/lidar_t.hpp>
#include <scanlock/scan_sector_t.hpp>
#include <sensor_msgs/PointCloud2.hpp>
#include <string>

#include "messages/decode_scan.hpp"
#include "messages/encode_scan.hpp"
#include "messages/generated_bytes.hpp"
#include "sample_scan.hpp"
#include "wire.hpp"

using namespace scanlock;

namespace {

mbot_lcm_msgs::lidar_t mbot_scan() {
  mbot_lcm_msgs::lidar_t message{};
  message.utime = 1700000000000000;
  message.num_ranges = 3;
  message.ranges = {2, 0, 3};
  message.thetas = {0, 1, static_cast<float>(M_PI / 2)};
  message.times = {1700000000000000, 1700000000050000, 1700000000100000};
  message.intensities = {5, 6, 7};
  return message;
}

}  // namespace

TEST_CASE("the types with x y z of each point give the scan back bit for bit") {
  const Scan scan = sample_scan(500);
  const Bytes messages[] = {encode_ros_pointcloud2(scan, {5, "os"}),
                            encode_drake_point_cloud(scan, {5, "os"}), encode_pointcloud(scan, {5, "os"})};
  for (const Bytes& bytes : messages) {
    const DecodedScan decoded = decode_scan(bytes.data(), bytes.size());
    CAPTURE(decoded.type);
    REQUIRE(decoded.error == "");
    CHECK(decoded.frame_id == "os");
    CHECK(decoded.scan.utime == scan.utime);
    CHECK(decoded.scan.points.x == scan.points.x);
    CHECK(decoded.scan.points.y == scan.points.y);
    CHECK(decoded.scan.points.z == scan.points.z);
    CHECK(decoded.scan.points.intensity == scan.points.intensity);
    CHECK(decoded.scan.points.time == scan.points.time);
  }
  CHECK(theirs<sensor_msgs::PointCloud2>(messages[0]).width == 500);
  CHECK(theirs<drake::lcmt_point_cloud>(messages[1]).point_step == 20);
  CHECK(theirs<bot_core::pointcloud_t>(messages[2]).channel_names ==
        std::vector<std::string>{"intensity", "t"});
}

TEST_CASE("drake point cloud in 64 bits") {
  auto message = theirs<drake::lcmt_point_cloud>(encode_drake_point_cloud(sample_scan(4)));
  message.width = std::numeric_limits<std::int64_t>::max();
  message.height = 4;
  CHECK(decode(message).fault == DecodeFault::kBadSize);
  message.width = 4;
  message.height = 1;
  message.filler = {1, 2, 3};
  message.filler_size = 3;
  CHECK(decode(message).error == "");
  message.row_step = std::numeric_limits<std::int64_t>::min();
  message.width = message.height = 2;
  CHECK(decode(message).fault == DecodeFault::kBadSize);
}

TEST_CASE("a planar scan becomes points at height zero") {
  bot_core::planar_lidar_t message{};
  message.utime = 9;
  message.ranges = {1, std::numeric_limits<float>::infinity(), 2, -1, 0, std::nanf("")};
  message.nranges = 6;
  message.rad0 = 0;
  message.radstep = static_cast<float>(M_PI / 4);
  DecodedScan decoded = decode(message);
  REQUIRE(decoded.error == "");
  REQUIRE(decoded.scan.points.size() == 2);
  CHECK(decoded.nonfinite_points == 4);
  CHECK(decoded.scan.points.x[0] == 1);
  CHECK(decoded.scan.points.y[1] == doctest::Approx(2));
  CHECK(decoded.scan.points.x[1] == doctest::Approx(0));
  CHECK(decoded.scan.points.z == std::vector<float>{0, 0});

  message.intensities = {1, 2, 3};
  message.nintensities = 3;
  CHECK(decode(message).fault == DecodeFault::kBadSize);
  message.intensities = {1, 2, 3, 4, 5, 6};
  message.nintensities = 6;
  CHECK(decode(message).scan.points.intensity == std::vector<float>{1, 3});
  message.radstep = std::nanf("");
  decoded = decode(message);
  CHECK(decoded.fault == DecodeFault::kBadField);
  CHECK(decoded.error.find("radstep") != std::string::npos);
}

TEST_CASE("planar ranges from planar_no_return_m on are no returns") {
  bot_core::planar_lidar_t message{};
  message.ranges = {1, 49.5f, 50, 81.91f};
  message.nranges = 4;
  CHECK(decode(message).scan.points.x == std::vector<float>{1, 49.5f});
  CHECK(decode(message).nonfinite_points == 2);
  DecodeLimits limits;
  limits.planar_no_return_m = 80;
  CHECK(decode(message, limits).scan.points.size() == 3);
}

TEST_CASE("an encoded planar scan has the nearest point of each beam") {
  Scan scan;
  scan.points.push_back(3, 0, 0);
  scan.points.push_back(2, 0, 0.1f);
  scan.points.push_back(1, 0, 5);  // far above the plane
  scan.points.push_back(0, -4, 0);
  const Bytes bytes = encode_planar_lidar(scan, 360);
  const DecodedScan decoded = decode_scan(bytes.data(), bytes.size());
  REQUIRE(decoded.error == "");
  REQUIRE(decoded.scan.points.size() == 2);
  CHECK(decoded.scan.points.y[0] == doctest::Approx(-4));
  CHECK(decoded.scan.points.x[1] == doctest::Approx(2));
}

TEST_CASE("the mbot scan has the time of each beam") {
  const DecodedScan decoded = decode(mbot_scan());
  REQUIRE(decoded.error == "");
  CHECK(decoded.type == "mbot_lcm_msgs.lidar_t");
  REQUIRE(decoded.scan.points.size() == 2);
  CHECK(decoded.nonfinite_points == 1);
  CHECK(decoded.scan.points.y[1] == doctest::Approx(3));
  CHECK(decoded.scan.points.time[0] == 0);
  CHECK(decoded.scan.points.time[1] == doctest::Approx(0.1));
  CHECK(decoded.scan.points.intensity == std::vector<float>{5, 7});
  DecodeLimits clockwise;
  clockwise.mbot_clockwise = true;
  CHECK(decode(mbot_scan(), clockwise).scan.points.y[1] == doctest::Approx(-3));
}

TEST_CASE("the point limit holds for every type") {
  DecodeLimits limits;
  limits.max_points = 2;
  const Scan scan = sample_scan(3);
  for (const Bytes& bytes :
       {encode_pointcloud2(scan), encode_ros_pointcloud2(scan), encode_drake_point_cloud(scan),
        encode_pointcloud(scan), encode_planar_lidar(scan, 3), encode_sectors(scan)[0],
        generated_bytes(mbot_scan())}) {
    const DecodedScan decoded = decode_scan(bytes.data(), bytes.size(), limits);
    CAPTURE(decoded.error);
    CHECK(decoded.fault == DecodeFault::kBadSize);
    CHECK(decoded.scan.points.empty());
  }
}

TEST_CASE("a sector that contradicts itself is a fault") {
  const auto good = theirs<scan_sector_t>(encode_sectors(sample_scan(10))[0]);
  CHECK(decode(good).error == "");
  auto bad = good;
  bad.sector_index = 1;
  CHECK(decode(bad).fault == DecodeFault::kBadSize);
  bad = good;
  bad.sector_count = -3;
  CHECK(decode(bad).fault == DecodeFault::kBadSize);
  bad = good;
  bad.num_times = 9;
  bad.times.resize(9);
  CHECK(decode(bad).fault == DecodeFault::kBadSize);
  for (const float nonsense : {std::nanf(""), 1e30f}) {
    bad = good;
    bad.coordinate_scale = nonsense;
    CHECK(decode(bad).fault == DecodeFault::kBadField);
    bad = good;
    bad.time_scale = nonsense;
    CHECK(decode(bad).fault == DecodeFault::kBadField);
    bad = good;
    bad.time_origin = nonsense;
    CHECK(decode(bad).fault == DecodeFault::kBadField);
  }
}
