// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/rigid.hpp"
#include "odometry/tracker_config.hpp"

namespace scanlock {

/// Where the sensor sits on the body; body axes are x forward, y left, z up.
struct MountConfig {
  double x_m = 0, y_m = 0, z_m = 0;                 ///< position of the sensor in the body frame
  double roll_deg = 0, pitch_deg = 0, yaw_deg = 0;  ///< R = Rz(yaw) Ry(pitch) Rx(roll), sensor to body
};
/// Maps coordinates of the sensor to coordinates of the body.
Pose body_from_sensor(const MountConfig& mount);

/// The values of map.up.
inline constexpr std::array kAxes = {"x", "-x", "y", "-y", "z", "-z"};

/// The map that outlives a run.
struct MapConfig {
  std::string file;           ///< empty: none is loaded or saved but on command; .ply or .pcd: a bare cloud
  std::string mode = "auto";  ///< extend, localise, or auto: localise for bare clouds, else extend
  std::string up = "z";       ///< of a bare cloud: x, y or z, or one of these with a minus
  double save_period_s = 60;  ///< 0: saved on exit and on command only
};

/// Everything about scanlockd that is not odometry. The table in `config_keys.cpp` explains each member.
struct DaemonConfig {
  std::string url;  ///< empty: LCM_DEFAULT_URL, else multicast on this host only
  std::vector<std::string> scan_channels = {"LIDAR"};
  int receive_buffer_bytes = 8388608;
  int max_message_bytes = 64 << 20;
  int max_points = 2000000;
  bool mbot_clockwise = false;
  double planar_no_return_m = 50;
  std::string command_channel = "SCANLOCK_COMMAND";
  std::string attitude_channel;        ///< bot_core.ins_t; empty: none, as for the next one
  std::string prior_odometry_channel;  ///< bot_core.pose_t of wheels, legs or whatever else
  double silence_warning_s = 5;

  std::string out_url;  ///< empty: as `url`, or the default when `url` is a log
  std::string pose_channel = "POSE_BODY_CORRECTED";
  std::string odometry_channel = "SCANLOCK_ODOMETRY";
  std::string status_channel = "SCANLOCK_STATUS";
  std::string recovery_channel = "SCANLOCK_RECOVERY";
  std::string local_pose_channel = "SCANLOCK_LOCAL_POSE";
  std::string local_to_map_channel;  ///< empty: not published; so are the next three
  std::string rigid_transform_channel;
  std::string nav_odometry_channel;
  std::string pose2d_channel;
  std::string twist_frame = "local";  ///< of the velocities in bot_core.pose_t: local, body or zero
  bool predicted_poses = true;        ///< of types that cannot say so; scanlock.odometry_t always comes
  std::string map_frame = "map";
  std::string body_frame = "body";
  double status_period_s = 1;

  MountConfig mount;
  MapConfig map;
};
/// `scan_channels` with commas between them.
std::string scan_channel_names(const DaemonConfig& config);

struct Config {
  DaemonConfig daemon;
  TrackerConfig tracker;
};

/// What is wrong with a configuration: file, line, key and what is expected, in one line.
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads a TOML file over the defaults. Throws ConfigError for a file that cannot be read, text that is not
/// TOML, an unknown key, a value of the wrong type or out of range.
Config load_config(const std::string& path);

/// The same for text; `name` stands for the file in errors.
Config parse_config(const std::string& text, const std::string& name);

/// Checks values that did not come from a file (command line); throws ConfigError naming the key.
void check_config(const Config& config);

/// The configuration as TOML, each key with its explanation, unit, range and default; parses back to
/// `config`.
std::string print_config(const Config& config);

}  // namespace scanlock
