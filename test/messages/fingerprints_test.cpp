// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/fingerprints.hpp"

#include <doctest/doctest.h>

#include <bot_core/ins_t.hpp>
#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pointcloud2_t.hpp>
#include <bot_core/pointcloud_t.hpp>
#include <bot_core/pose_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <drake/lcmt_point_cloud.hpp>
#include <mbot_lcm_msgs/lidar_t.hpp>
#include <mbot_lcm_msgs/pose2D_t.hpp>
#include <nav_msgs/Odometry.hpp>
#include <scanlock/command_t.hpp>
#include <scanlock/odometry_t.hpp>
#include <scanlock/recovery_t.hpp>
#include <scanlock/scan_sector_t.hpp>
#include <scanlock/status_t.hpp>
#include <sensor_msgs/PointCloud2.hpp>
#include <string>

using namespace scanlock;

namespace {

template <typename Message>
std::uint64_t generated() {
  return static_cast<std::uint64_t>(Message::getHash());
}

}  // namespace

// These fingerprints were computed from copies of the types in other projects: a change here breaks
// compatibility with them.
TEST_CASE("the fingerprints of the ecosystem are the golden ones") {
  CHECK(generated<bot_core::pose_t>() == 0x2e16efb052b0105eu);
  CHECK(generated<bot_core::rigid_transform_t>() == 0xea9ffbf2acc5c5aeu);
  CHECK(generated<bot_core::pointcloud2_t>() == 0x0bcd5ce4bf5a1b4au);
  CHECK(generated<bot_core::pointcloud_t>() == 0x0d89dc76eb295069u);
  CHECK(generated<bot_core::planar_lidar_t>() == 0xe3d17423180b5e8du);
  CHECK(generated<bot_core::ins_t>() == 0x88a7df61422b0840u);
  CHECK(generated<drake::lcmt_point_cloud>() == 0x17f2c128b5d25a95u);
  CHECK(generated<sensor_msgs::PointCloud2>() == 0xf5eb3da1c2853175u);
  CHECK(generated<nav_msgs::Odometry>() == 0x94e17f94648cf0e4u);
  CHECK(generated<mbot_lcm_msgs::lidar_t>() == 0x89dc5b879a5056cfu);
  CHECK(generated<mbot_lcm_msgs::pose2D_t>() == 0x1f317af1246276acu);
}

// A changed fingerprint makes our messages incompatible with recorded logs and other programs.
TEST_CASE("the fingerprints of our own types are pinned") {
  CHECK(generated<odometry_t>() == 0x45be9166d28b2ef0u);
  CHECK(generated<status_t>() == 0x05e9a23aa429a5b3u);
  CHECK(generated<recovery_t>() == 0x4ddfc198365ba933u);
  CHECK(generated<command_t>() == 0x12352c27f5965257u);
  CHECK(generated<scan_sector_t>() == 0x43807f72da1389a7u);
}

TEST_CASE("the fingerprint constants equal those that lcm-gen computes") {
  CHECK(generated<bot_core::pose_t>() == fingerprint::kPose);
  CHECK(generated<bot_core::rigid_transform_t>() == fingerprint::kRigidTransform);
  CHECK(generated<bot_core::pointcloud2_t>() == fingerprint::kPointcloud2);
  CHECK(generated<bot_core::pointcloud_t>() == fingerprint::kPointcloud);
  CHECK(generated<bot_core::planar_lidar_t>() == fingerprint::kPlanarLidar);
  CHECK(generated<bot_core::ins_t>() == fingerprint::kIns);
  CHECK(generated<drake::lcmt_point_cloud>() == fingerprint::kDrakePointCloud);
  CHECK(generated<sensor_msgs::PointCloud2>() == fingerprint::kRosPointCloud2);
  CHECK(generated<nav_msgs::Odometry>() == fingerprint::kNavOdometry);
  CHECK(generated<mbot_lcm_msgs::lidar_t>() == fingerprint::kMbotLidar);
  CHECK(generated<mbot_lcm_msgs::pose2D_t>() == fingerprint::kPose2d);
  CHECK(generated<odometry_t>() == fingerprint::kOdometry);
  CHECK(generated<status_t>() == fingerprint::kStatus);
  CHECK(generated<recovery_t>() == fingerprint::kRecovery);
  CHECK(generated<command_t>() == fingerprint::kCommand);
  CHECK(generated<scan_sector_t>() == fingerprint::kScanSector);
}

TEST_CASE("a fingerprint is read big endian and has a name") {
  const std::uint8_t bytes[] = {0x2e, 0x16, 0xef, 0xb0, 0x52, 0xb0, 0x10, 0x5e, 0xff};
  CHECK(message_fingerprint(bytes, sizeof bytes) == fingerprint::kPose);
  CHECK(message_fingerprint(bytes, 7) == 0);
  CHECK(message_fingerprint(nullptr, 100) == 0);
  CHECK(std::string(type_name(fingerprint::kPose)) == "bot_core.pose_t");
  CHECK(type_name(1) == nullptr);
}
