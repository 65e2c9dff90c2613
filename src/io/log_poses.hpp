// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "io/trajectory.hpp"

namespace scanlock {

/// The pose in a message of one of the pose types: bot_core.pose_t, bot_core.rigid_transform_t,
/// mbot_lcm_msgs.pose2D_t, nav_msgs.Odometry, scanlock.odometry_t. Its time is the message's own stamp in
/// seconds. Returns nothing for any other type and for damaged or non-finite content; `error` then states the
/// reason.
std::optional<StampedPose> decode_pose(const std::uint8_t* data, std::size_t size, std::string& error);

struct LogPoses {
  Trajectory trajectory;     ///< in the order of the log, with the messages' own stamps
  std::size_t rejected = 0;  ///< messages of the channel that hold no valid pose
  std::string first_error;   ///< the reason for the first rejected message
  std::string damage;        ///< a sentence when the log is damaged or cut, else empty; the readable poses
                             ///< are in `trajectory`
};

/// The poses on one channel of a log. When the channel holds no pose, throws std::runtime_error naming the
/// file and the channel, and either the first error or the channels of the log.
LogPoses read_log_poses(const std::string& path, const std::string& channel);

/// True when the extension is .lcmlog or the file begins with the sync word of an LCM log.
bool is_log(const std::string& path);

class LogReader;
/// A sentence on the damage of a log that was read to its end; empty when it has none.
std::string damage_sentence(const LogReader& reader);

}  // namespace scanlock
