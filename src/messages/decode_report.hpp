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

/// A decoded value, or what was wrong with the message. Never read `value` with a fault.
template <typename Value>
struct Decoded {
  DecodeFault fault = DecodeFault::kNone;
  std::string error;  ///< a sentence that names the member at fault
  Value value;
  bool ok() const { return fault == DecodeFault::kNone; }
};

/// The pose in any of the types that carry one.
struct PoseReport {
  std::string type;  ///< for instance "bot_core.pose_t"
  std::int64_t utime = 0;
  Pose map_from_body = Pose::Identity();
  std::optional<TrackingState> state;  ///< scanlock.odometry_t only
};

/// bot_core.ins_t, as far as it can serve as a prior.
struct AttitudeReport {
  std::int64_t utime = 0;
  Eigen::Quaterniond local_from_body = Eigen::Quaterniond::Identity();
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();  ///< rad/s
};

/// Each reads through a bounded reader and never throws but for lack of memory. A pose that is not finite, a
/// quaternion far from unit length and a number outside its enumeration are faults (kBadField); quaternions
/// come out normalised.

/// bot_core.pose_t, bot_core.rigid_transform_t, nav_msgs.Odometry, mbot_lcm_msgs.pose2D_t,
/// scanlock.odometry_t.
Decoded<PoseReport> decode_pose(const std::uint8_t* data, std::size_t size);
Decoded<OdometryReport> decode_odometry(const std::uint8_t* data, std::size_t size);
Decoded<StatusReport> decode_status(const std::uint8_t* data, std::size_t size);
Decoded<RecoveryReport> decode_recovery(const std::uint8_t* data, std::size_t size);
Decoded<Command> decode_command(const std::uint8_t* data, std::size_t size);
Decoded<AttitudeReport> decode_attitude(const std::uint8_t* data, std::size_t size);

}  // namespace scanlock
