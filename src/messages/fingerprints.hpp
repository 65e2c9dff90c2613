// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace scanlock {

/// The first eight bytes of every LCM message: a hash of the members' names and types; the name of the struct
/// is not part of it. `test/messages/fingerprints_test.cpp` compares these constants with lcm-gen's.
namespace fingerprint {
constexpr std::uint64_t kPointcloud2 = 0x0bcd5ce4bf5a1b4a;      // bot_core.pointcloud2_t
constexpr std::uint64_t kPointcloud = 0x0d89dc76eb295069;       // bot_core.pointcloud_t
constexpr std::uint64_t kPlanarLidar = 0xe3d17423180b5e8d;      // bot_core.planar_lidar_t
constexpr std::uint64_t kDrakePointCloud = 0x17f2c128b5d25a95;  // drake.lcmt_point_cloud
constexpr std::uint64_t kRosPointCloud2 = 0xf5eb3da1c2853175;   // sensor_msgs.PointCloud2
constexpr std::uint64_t kMbotLidar = 0x89dc5b879a5056cf;        // mbot_lcm_msgs.lidar_t
constexpr std::uint64_t kScanSector = 0x43807f72da1389a7;       // scanlock.scan_sector_t
constexpr std::uint64_t kPose = 0x2e16efb052b0105e;             // bot_core.pose_t
constexpr std::uint64_t kRigidTransform = 0xea9ffbf2acc5c5ae;   // bot_core.rigid_transform_t
constexpr std::uint64_t kIns = 0x88a7df61422b0840;              // bot_core.ins_t
constexpr std::uint64_t kNavOdometry = 0x94e17f94648cf0e4;      // nav_msgs.Odometry
constexpr std::uint64_t kPose2d = 0x1f317af1246276ac;           // mbot_lcm_msgs.pose2D_t
constexpr std::uint64_t kOdometry = 0x45be9166d28b2ef0;         // scanlock.odometry_t
constexpr std::uint64_t kStatus = 0x05e9a23aa429a5b3;           // scanlock.status_t
constexpr std::uint64_t kRecovery = 0x4ddfc198365ba933;         // scanlock.recovery_t
constexpr std::uint64_t kCommand = 0x12352c27f5965257;          // scanlock.command_t
}  // namespace fingerprint

/// The fingerprint of a message; 0, which no known type has, when it is shorter than eight bytes.
std::uint64_t message_fingerprint(const std::uint8_t* data, std::size_t size);

/// "bot_core.pose_t" and so on for the types above, nullptr for any other type.
const char* type_name(std::uint64_t message_fingerprint);

/// Whether the type is one of those above that hold a scan or a sector of a scan.
bool is_scan_type(std::uint64_t message_fingerprint);

}  // namespace scanlock
