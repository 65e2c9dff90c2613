// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "messages/reports.hpp"

namespace scanlock {

/// A complete LCM message, starting with the fingerprint.
using Bytes = std::vector<std::uint8_t>;

/// The frame of `vel` and `rotation_rate` in bot_core.pose_t. The type does not define it, and its two user
/// communities differ: libbot2 uses the local (map) frame, openhumanoids the body frame.
enum class TwistFrame : std::int8_t { kLocal, kBody, kZero };

/// Each message is stamped with the utime of the scan.
Bytes encode_pose(const TrackedScan& tracked, TwistFrame twist_frame);  ///< bot_core.pose_t
Bytes encode_rigid_transform(const TrackedScan& tracked);  ///< bot_core.rigid_transform_t, map from body
Bytes encode_pose2d(const TrackedScan& tracked);           ///< mbot_lcm_msgs.pose2D_t: x, y, yaw
/// nav_msgs.Odometry. The covariance of the pose is rotated into the header's frame (rotations about its
/// fixed axes), as the type defines it. The covariance of the twist is not known; its first element is -1,
/// the type's convention for that.
Bytes encode_nav_odometry(const TrackedScan& tracked, const std::string& frame_id,
                          const std::string& child_frame_id, std::int32_t seq);
Bytes encode_odometry(const TrackedScan& tracked, const OdometryContext& context);  ///< scanlock.odometry_t
Bytes encode_status(const StatusReport& report);                                    ///< scanlock.status_t
Bytes encode_recovery(const RecoveryReport& report);                                ///< scanlock.recovery_t
Bytes encode_command(const Command& command);                                       ///< scanlock.command_t

}  // namespace scanlock
