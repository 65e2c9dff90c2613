// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "messages/decode_scan.hpp"
#include "messages/reports.hpp"

namespace scanlock {

/// A decoded value, or the error in the message. Do not read `value` when there is a fault.
template <typename Value>
struct Decoded {
  DecodeFault fault = DecodeFault::kNone;
  std::string error;  ///< a sentence that names the member at fault
  Value value;
  bool ok() const { return fault == DecodeFault::kNone; }
};

/// The pose of a message of any type that carries one.
struct PoseReport {
  std::string type;  ///< for instance "bot_core.pose_t"
  std::int64_t utime = 0;
  Pose map_from_body = Pose::Identity();
  std::optional<TrackingState> state;  ///< scanlock.odometry_t only
};

/// bot_core.ins_t: the members that scanlock uses.
struct AttitudeReport {
  std::int64_t utime = 0;
  Eigen::Quaterniond local_from_body = Eigen::Quaterniond::Identity();
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();  ///< rad/s
};

/// Each decoder checks every size before it reads, and throws only when memory runs out. A pose that is not
/// finite, a quaternion whose length is not between 0.9 and 1.1, and a number outside its enumeration are
/// faults (kBadField). Quaternions are returned normalised.

/// bot_core.pose_t, bot_core.rigid_transform_t, nav_msgs.Odometry, mbot_lcm_msgs.pose2D_t,
/// scanlock.odometry_t.
Decoded<PoseReport> decode_pose(const std::uint8_t* data, std::size_t size);
Decoded<OdometryReport> decode_odometry(const std::uint8_t* data, std::size_t size);
Decoded<StatusReport> decode_status(const std::uint8_t* data, std::size_t size);
Decoded<RecoveryReport> decode_recovery(const std::uint8_t* data, std::size_t size);
Decoded<Command> decode_command(const std::uint8_t* data, std::size_t size);
Decoded<AttitudeReport> decode_attitude(const std::uint8_t* data, std::size_t size);

}  // namespace scanlock
