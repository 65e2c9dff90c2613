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

/// Pose of the sensor on the body; body axes are x forward, y left, z up.
struct MountConfig {
  double x_m = 0, y_m = 0, z_m = 0;                 ///< metres, position of the sensor in the body frame
  double roll_deg = 0, pitch_deg = 0, yaw_deg = 0;  ///< R = Rz(yaw) Ry(pitch) Rx(roll), sensor to body
};
/// Transforms coordinates of the sensor to coordinates of the body.
Pose body_from_sensor(const MountConfig& mount);

/// The permitted values of map.up.
inline constexpr std::array kAxes = {"x", "-x", "y", "-y", "z", "-z"};

/// The map that is kept from one run to the next.
struct MapConfig {
  std::string file;           ///< empty: loaded and saved on command only; .ply or .pcd: a bare cloud
  std::string mode = "auto";  ///< extend, localise, or auto: localise in a bare cloud, extend otherwise
  std::string up = "z";       ///< upward axis of a bare cloud: x, y or z, or one of them with a minus
  double save_period_s = 60;  ///< 0: saved only on exit and on command
};

/// All settings of scanlockd that do not concern odometry. The table in `config_keys.cpp` explains each
/// member.
struct DaemonConfig {
  std::string url;  ///< empty: LCM_DEFAULT_URL if set, otherwise multicast on this host only
  std::vector<std::string> scan_channels = {"LIDAR"};
  int receive_buffer_bytes = 8388608;
  int max_message_bytes = 64 << 20;
  int max_points = 2000000;
  bool mbot_clockwise = false;
  double planar_no_return_m = 50;
  std::string command_channel = "SCANLOCK_COMMAND";
  std::string attitude_channel;        ///< bot_core.ins_t; empty: none
  std::string prior_odometry_channel;  ///< bot_core.pose_t of another odometry (wheels, legs); empty: none
  double silence_warning_s = 5;

  std::string out_url;  ///< empty: as `url`, or the default when `url` is a log
  std::string pose_channel = "POSE_BODY_CORRECTED";
  std::string odometry_channel = "SCANLOCK_ODOMETRY";
  std::string status_channel = "SCANLOCK_STATUS";
  std::string recovery_channel = "SCANLOCK_RECOVERY";
  std::string local_pose_channel = "SCANLOCK_LOCAL_POSE";
  std::string local_to_map_channel;  ///< empty: not published; the same holds for the next three
  std::string rigid_transform_channel;
  std::string nav_odometry_channel;
  std::string pose2d_channel;
  std::string twist_frame = "local";  ///< of the velocities in bot_core.pose_t: local, body or zero
  bool predicted_poses = true;        ///< publish them as types without a state, too, not only odometry_t
  std::string map_frame = "map";
  std::string body_frame = "body";
  double status_period_s = 1;

  MountConfig mount;
  MapConfig map;
};
/// `scan_channels`, separated by commas.
std::string scan_channel_names(const DaemonConfig& config);

struct Config {
  DaemonConfig daemon;
  TrackerConfig tracker;
};

/// An error in a configuration, in one line: file, line, key and the expected value.
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads a TOML file; keys that it does not set keep their defaults. Throws ConfigError for a file that
/// cannot be read, text that is not TOML, an unknown key, and a value of the wrong type or out of range.
Config load_config(const std::string& path);

/// As load_config(), from text; `name` is the file name in errors.
Config parse_config(const std::string& text, const std::string& name);

/// Checks values that do not come from a file (command line); throws ConfigError naming the key.
void check_config(const Config& config);

/// The configuration as TOML, each key with its explanation, unit, range and default; parses back to
/// `config`.
std::string print_config(const Config& config);

}  // namespace scanlock
