// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "io/trajectory.hpp"

namespace scanlock {

/// The channel on which scanlockd publishes its poses.
constexpr const char* kDefaultPoseChannel = "POSE_BODY_CORRECTED";

struct LoadedTrajectory {
  Trajectory trajectory;
  bool has_times = true;  ///< false for KITTI, whose poses are only numbered
  std::string name;       ///< short, for a heading: the file name, with the channel of a log
  std::string warning;    ///< a sentence for the person at the terminal, or empty
};

/// The file of what load_trajectory() takes.
std::string trajectory_file(const std::string& source);

/// Loads what a person names on a command line: a TUM or KITTI file (told apart by content), LOG:CHANNEL, or
/// LOG alone for kDefaultPoseChannel. Throws std::runtime_error as the readers do.
LoadedTrajectory load_trajectory(const std::string& source);

}  // namespace scanlock
