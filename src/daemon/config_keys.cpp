// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/config_keys.hpp"

namespace scanlock {
namespace {

constexpr double kMaxChannelLength = 63;  // LCM's own limit; publishing on a longer name fails

template <typename T>
ConfigKey make_key(const char* section, const char* name, T DaemonConfig::*member, const char* unit,
                   double min, double max, const char* help, std::vector<std::string> choices = {}) {
  return {section, name, unit, min, max, help, std::move(choices), Access<T>([member](Config& config) -> T& {
            return config.daemon.*member;
          })};
}

template <typename T>
ConfigKey make_key(const char* section, const char* name, T MountConfig::*member, const char* unit,
                   double min, double max, const char* help) {
  return {
      section, name, unit, min,
      max,     help, {},   Access<T>([member](Config& config) -> T& { return config.daemon.mount.*member; })};
}

template <typename T>
ConfigKey make_key(const char* section, const char* name, T MapConfig::*member, const char* unit, double min,
                   double max, const char* help, std::vector<std::string> choices = {}) {
  return {section, name, unit, min, max, help, std::move(choices), Access<T>([member](Config& config) -> T& {
            return config.daemon.map.*member;
          })};
}

template <typename T>
ConfigKey make_key(const char* section, const char* name, T TrackerConfig::*member, const char* unit,
                   double min, double max, const char* help) {
  return {section, name, unit, min,
          max,     help, {},   Access<T>([member](Config& config) -> T& { return config.tracker.*member; })};
}

std::vector<ConfigKey> make_table() {
  using D = DaemonConfig;
  using M = MountConfig;
  using F = MapConfig;
  using T = TrackerConfig;
// clang-format off
#define TRACKER(member, unit, min, max, help) make_key("tracker", #member, &T::member, unit, min, max, help)
  return {
    make_key("input", "url", &D::url, "", 0, 1000, "LCM URL of the scans; empty: LCM_DEFAULT_URL, else multicast on this host only; file:// replays a log in lock-step"),
    make_key("input", "scan_channels", &D::scan_channels, "", 1, 16, "channels that carry scans; literal names, not patterns"),
    make_key("input", "receive_buffer_bytes", &D::receive_buffer_bytes, "bytes", 65536, 1 << 30, "receive buffer requested from the kernel, which grants net.core.rmem_max at most; a recv_buf_size in the URL takes precedence"),
    make_key("input", "max_message_bytes", &D::max_message_bytes, "bytes", 1024, 1 << 28, "larger messages are rejected unread"),
    make_key("input", "max_points", &D::max_points, "points", 1, 20000000, "scans of more points are rejected"),
    make_key("input", "mbot_clockwise", &D::mbot_clockwise, "", 0, 1, "direction of the angles in mbot's lidar_t: false if they grow counter-clockwise, seen from above"),
    make_key("input", "planar_no_return_m", &D::planar_no_return_m, "m", 1, 10000, "ranges of planar_lidar_t and mbot's lidar_t from this value on count as no return: for a beam without a return, scanners write their largest number"),
    make_key("input", "command_channel", &D::command_channel, "", 0, kMaxChannelLength, "scanlock.command_t: set pose, reset, save map, load map; empty: no commands are received"),
    make_key("input", "attitude_channel", &D::attitude_channel, "", 0, kMaxChannelLength, "bot_core.ins_t of the body: its roll and pitch give the vertical; empty: none"),
    make_key("input", "prior_odometry_channel", &D::prior_odometry_channel, "", 0, kMaxChannelLength, "bot_core.pose_t of the body from another odometry (wheels, legs): its motion from scan to scan serves as a prediction; empty: none"),
    make_key("input", "silence_warning_s", &D::silence_warning_s, "s", 0.5, 86400, "time without a usable scan after which a warning is logged, repeated at growing intervals"),

    make_key("output", "url", &D::out_url, "", 0, 1000, "LCM URL of all published messages; empty: that of the input, unless that is a log"),
    make_key("output", "pose_channel", &D::pose_channel, "", 0, kMaxChannelLength, "bot_core.pose_t for each scan; empty: not published"),
    make_key("output", "odometry_channel", &D::odometry_channel, "", 0, kMaxChannelLength, "scanlock.odometry_t for each scan; empty: not published"),
    make_key("output", "status_channel", &D::status_channel, "", 0, kMaxChannelLength, "scanlock.status_t each period and at each change of state; empty: not published"),
    make_key("output", "recovery_channel", &D::recovery_channel, "", 0, kMaxChannelLength, "scanlock.recovery_t at the end of each relocalisation search; empty: not published"),
    make_key("output", "local_pose_channel", &D::local_pose_channel, "", 0, kMaxChannelLength, "bot_core.pose_t of the same motion in a frame that never jumps, and drifts instead; empty: not published"),
    make_key("output", "local_to_map_channel", &D::local_to_map_channel, "", 0, kMaxChannelLength, "bot_core.rigid_transform_t from the frame of local_pose_channel to the map, for instance LOCAL_TO_MAP; empty: not published"),
    make_key("output", "rigid_transform_channel", &D::rigid_transform_channel, "", 0, kMaxChannelLength, "bot_core.rigid_transform_t, for instance BODY_TO_LOCAL; empty: not published"),
    make_key("output", "nav_odometry_channel", &D::nav_odometry_channel, "", 0, kMaxChannelLength, "nav_msgs.Odometry, for instance /odometry#nav_msgs.Odometry; empty: not published"),
    make_key("output", "pose2d_channel", &D::pose2d_channel, "", 0, kMaxChannelLength, "pose2D_t of mbot, for instance SLAM_POSE; empty: not published"),
    make_key("output", "twist_frame", &D::twist_frame, "", 0, 16, "frame of the velocities in bot_core.pose_t: local as libbot2 has it, body as openhumanoids has it, zero to leave them out", {"local", "body", "zero"}),
    make_key("output", "predicted_poses", &D::predicted_poses, "", 0, 1, "while the pose is only predicted (RECOVERING, AMBIGUOUS, LOST), publish it also as message types that cannot mark it as predicted; scanlock.odometry_t is always published"),
    make_key("output", "map_frame", &D::map_frame, "", 0, 255, "name of the map frame in messages that carry one"),
    make_key("output", "body_frame", &D::body_frame, "", 0, 255, "name of the body frame in messages that carry one"),
    make_key("output", "status_period_s", &D::status_period_s, "s", 0.1, 3600, "time between two status messages"),

    make_key("mount", "x_m", &M::x_m, "m", -100, 100, "position of the sensor on the body, forward"),
    make_key("mount", "y_m", &M::y_m, "m", -100, 100, "position of the sensor on the body, left"),
    make_key("mount", "z_m", &M::z_m, "m", -100, 100, "position of the sensor on the body, up"),
    make_key("mount", "roll_deg", &M::roll_deg, "deg", -180, 180, "rotation of the sensor about the body's x axis; R = Rz(yaw) Ry(pitch) Rx(roll)"),
    make_key("mount", "pitch_deg", &M::pitch_deg, "deg", -180, 180, "rotation of the sensor about the body's y axis"),
    make_key("mount", "yaw_deg", &M::yaw_deg, "deg", -180, 180, "rotation of the sensor about the body's z axis"),

    make_key("map", "file", &F::file, "", 0, 4000, "map to relocalise in at the start, if the file exists, and to save to on exit; .ply or .pcd: a bare cloud from any program, which is never written; empty: none"),
    make_key("map", "mode", &F::mode, "", 0, 16, "localise: the map is not changed; extend: it grows, and is saved (for a bare cloud as a .map beside it); auto: localise in a bare cloud, else extend", {"auto", "extend", "localise"}),
    make_key("map", "up", &F::up, "", 0, 2, "axis of a bare cloud that points upwards", {kAxes.begin(), kAxes.end()}),
    make_key("map", "save_period_s", &F::save_period_s, "s", 0, 86400, "interval at which a map that has grown is also saved, in case the daemon does not exit cleanly; 0: only on exit"),

    TRACKER(min_range_m, "m", 0, 1000, "returns nearer than this are dropped, as they are of the robot itself; for planar scanners see planar_min_range_m"),
    TRACKER(planar_min_range_m, "m", 0, 1000, "the same for planar scanners, most of which are mounted so that they do not see the robot"),
    TRACKER(max_range_m, "m", 1, 10000, "returns farther than this are dropped"),
    TRACKER(threads, "threads", 1, 256, "worker threads of one alignment; the result does not depend on it"),
    TRACKER(map_points_per_scan, "points", 100, 1000000, "the voxel size of the map is chosen so that about this many points of a scan are left"),
    TRACKER(min_voxel_m, "m", 0.001, 10, "smallest voxel size of the map"),
    TRACKER(max_voxel_m, "m", 0.001, 100, "largest voxel size of the map"),
    TRACKER(max_source_points, "points", 50, 1000000, "largest number of points of a scan that are aligned"),
    TRACKER(acceleration, "m/s^2", 0, 1000, "standard deviation of the robot's acceleration; a larger one widens the prediction"),
    TRACKER(angular_acceleration, "rad/s^2", 0, 10000, "standard deviation of the robot's angular acceleration; likewise"),
    TRACKER(max_keyframes, "keyframes", 1, 10000, "largest number of keyframes in the map around the robot"),
    TRACKER(max_map_points, "points", 1000, 20000000, "largest number of points in the map around the robot"),
    TRACKER(max_archive_points, "points", 1000, 200000000, "largest number of points in all keyframes that are kept for relocalisation and loop closure, 12 bytes each; the oldest keyframes are dropped. Keyframes of a loaded map do not count, and are never dropped"),

    make_key("recovery", "search_cores", &T::search_cores, "cores", 0.01, 64, "CPU cores that relocalisation searches may use, averaged over a minute; with more, difficult searches end sooner"),
    make_key("recovery", "new_map_after_s", &T::new_map_after_s, "s", 1, 86400, "time without relocalisation after which a robot whose scans fit each other goes on in a new map: TRACKING, in a new epoch; searches in the old map continue"),
  };
#undef TRACKER
  // clang-format on
}

}  // namespace

const std::vector<ConfigKey>& config_keys() {
  static const std::vector<ConfigKey> table = make_table();
  return table;
}

}  // namespace scanlock
