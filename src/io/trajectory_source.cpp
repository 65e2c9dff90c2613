// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/trajectory_source.hpp"

#include <filesystem>

#include "io/log_poses.hpp"

namespace scanlock {

std::string trajectory_file(const std::string& source) {
  std::error_code error;
  return std::filesystem::exists(source, error) ? source : source.substr(0, source.rfind(':'));
}

LoadedTrajectory load_trajectory(const std::string& source) {
  const std::string path = trajectory_file(source);
  const bool names_channel = path != source;
  const std::string channel = names_channel ? source.substr(path.size() + 1) : kDefaultPoseChannel;
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
