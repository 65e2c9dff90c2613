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
  bool has_times = true;  ///< false for KITTI, whose poses have only an index
  std::string name;       ///< short, for a heading: the file name, and the channel if it is a log
  std::string warning;    ///< a sentence for the user, or empty
};

/// The path of the file in an argument of load_trajectory().
std::string trajectory_file(const std::string& source);

/// Loads a trajectory named on a command line: a TUM or KITTI file (distinguished by content), LOG:CHANNEL,
/// or LOG alone for kDefaultPoseChannel. Throws std::runtime_error as the readers do.
LoadedTrajectory load_trajectory(const std::string& source);

}  // namespace scanlock
