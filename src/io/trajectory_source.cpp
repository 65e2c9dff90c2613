// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/trajectory_source.hpp"

#include <filesystem>

#include "io/log_poses.hpp"

namespace scanlock {

LoadedTrajectory load_trajectory(const std::string& source) {
  std::string path = source, channel = kDefaultPoseChannel;
  const std::size_t colon = source.rfind(':');
  const bool names_channel = colon != std::string::npos && !std::filesystem::exists(source);
  if (names_channel) {
    path = source.substr(0, colon);
    channel = source.substr(colon + 1);
  }
  LoadedTrajectory loaded;
  loaded.name = std::filesystem::path(path).filename().string();
  if (!names_channel && !is_log(path)) {
    loaded.has_times = is_tum(path);
    loaded.trajectory = loaded.has_times ? read_tum(path) : read_kitti(path);
    return loaded;
  }
  LogPoses poses = read_log_poses(path, channel);
  loaded.trajectory = std::move(poses.trajectory);
  loaded.name += ":" + channel;
  if (poses.rejected > 0)
    loaded.warning = std::to_string(poses.rejected) + " messages on " + channel + " hold no pose (" +
                     poses.first_error + ")";
  if (!poses.damage.empty()) loaded.warning += (loaded.warning.empty() ? "" : "; ") + poses.damage;
  return loaded;
}

}  // namespace scanlock
