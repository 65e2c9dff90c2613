// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "messages/reports.hpp"

namespace scanlock {

/// A whole LCM message, fingerprint first.
using Bytes = std::vector<std::uint8_t>;

/// What `vel` and `rotation_rate` of bot_core.pose_t are expressed in. The type itself does not say, and its
/// two communities disagree: libbot2 means the local (map) frame, openhumanoids the body frame.
enum class TwistFrame : std::int8_t { kLocal, kBody, kZero };

/// Each is stamped with the scan's own utime.
Bytes encode_pose(const TrackedScan& tracked, TwistFrame twist_frame);  ///< bot_core.pose_t
Bytes encode_rigid_transform(const TrackedScan& tracked);  ///< bot_core.rigid_transform_t, map from body
Bytes encode_pose2d(const TrackedScan& tracked);           ///< mbot_lcm_msgs.pose2D_t: x, y, yaw
/// nav_msgs.Odometry: the covariance is turned into the frame of the header, about fixed axes, as that type
/// wants it. The covariance of the twist is not known: it is -1 in the first element, which is the type's way
/// to say so.
Bytes encode_nav_odometry(const TrackedScan& tracked, const std::string& frame_id,
                          const std::string& child_frame_id, std::int32_t seq);
Bytes encode_odometry(const TrackedScan& tracked, const OdometryContext& context);  ///< scanlock.odometry_t
Bytes encode_status(const StatusReport& report);                                    ///< scanlock.status_t
Bytes encode_recovery(const RecoveryReport& report);                                ///< scanlock.recovery_t
Bytes encode_command(const Command& command);                                       ///< scanlock.command_t

}  // namespace scanlock
