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
/// mbot_lcm_msgs.pose2D_t, nav_msgs.Odometry, scanlock.odometry_t. Time in seconds from its own stamp.
/// Nothing for any other type and for damaged or non-finite content; `error` then says what is wrong.
std::optional<StampedPose> decode_pose(const std::uint8_t* data, std::size_t size, std::string& error);

struct LogPoses {
  Trajectory trajectory;     ///< in the order of the log, by the poses' own stamps
  std::size_t rejected = 0;  ///< messages of the channel that hold no valid pose
  std::string first_error;   ///< of the first of them
  std::string damage;        ///< a sentence when the log is damaged or cut; what could be read is there
};

/// The poses on one channel of a log. Throws std::runtime_error naming the file, the channel and the channels
/// that there are when it holds no pose.
LogPoses read_log_poses(const std::string& path, const std::string& channel);

/// True when the file begins as an LCM log does, or is called .lcmlog.
bool is_log(const std::string& path);

class LogReader;
/// "" or a sentence on the state of a log that was read to its end.
std::string damage_sentence(const LogReader& reader);

}  // namespace scanlock
