// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/fingerprints.hpp"

namespace scanlock {

std::uint64_t message_fingerprint(const std::uint8_t* data, std::size_t size) {
  if (data == nullptr || size < 8) return 0;
  std::uint64_t value = 0;
  for (int i = 0; i < 8; ++i) value = value << 8 | data[i];
  return value;
}

bool is_scan_type(std::uint64_t message_fingerprint) {
  switch (message_fingerprint) {
    case fingerprint::kPointcloud2:
    case fingerprint::kPointcloud:
    case fingerprint::kPlanarLidar:
    case fingerprint::kDrakePointCloud:
    case fingerprint::kRosPointCloud2:
    case fingerprint::kMbotLidar:
    case fingerprint::kScanSector:
      return true;
    default:
      return false;
  }
}

const char* type_name(std::uint64_t message_fingerprint) {
  switch (message_fingerprint) {
    case fingerprint::kPointcloud2:
      return "bot_core.pointcloud2_t";
    case fingerprint::kPointcloud:
      return "bot_core.pointcloud_t";
    case fingerprint::kPlanarLidar:
      return "bot_core.planar_lidar_t";
    case fingerprint::kDrakePointCloud:
      return "drake.lcmt_point_cloud";
    case fingerprint::kRosPointCloud2:
      return "sensor_msgs.PointCloud2";
    case fingerprint::kMbotLidar:
      return "mbot_lcm_msgs.lidar_t";
    case fingerprint::kScanSector:
      return "scanlock.scan_sector_t";
    case fingerprint::kPose:
      return "bot_core.pose_t";
    case fingerprint::kRigidTransform:
      return "bot_core.rigid_transform_t";
    case fingerprint::kIns:
      return "bot_core.ins_t";
    case fingerprint::kNavOdometry:
      return "nav_msgs.Odometry";
    case fingerprint::kPose2d:
      return "mbot_lcm_msgs.pose2D_t";
    case fingerprint::kOdometry:
      return "scanlock.odometry_t";
    case fingerprint::kStatus:
      return "scanlock.status_t";
    case fingerprint::kRecovery:
      return "scanlock.recovery_t";
    case fingerprint::kCommand:
      return "scanlock.command_t";
    default:
      return nullptr;
  }
}

}  // namespace scanlock
