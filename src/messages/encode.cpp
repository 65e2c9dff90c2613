// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/encode.hpp"

#include <bot_core/pose_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <cmath>
#include <mbot_lcm_msgs/pose2D_t.hpp>
#include <nav_msgs/Odometry.hpp>
#include <scanlock/command_t.hpp>
#include <scanlock/odometry_t.hpp>
#include <scanlock/recovery_t.hpp>
#include <scanlock/status_t.hpp>

#include "geometry/elementary.hpp"
#include "messages/generated_bytes.hpp"

namespace scanlock {
namespace {

void set_vector(const Eigen::Vector3d& from, double (&to)[3]) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

/// A unit quaternion with w >= 0, so that equal rotations give equal bytes.
Eigen::Quaterniond quaternion_of(const Pose& pose) {
  Eigen::Quaterniond q(pose.rotation());
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return q;
}

void set_quaternion(const Pose& pose, double (&wxyz)[4]) {
  const Eigen::Quaterniond q = quaternion_of(pose);
  wxyz[0] = q.w();
  wxyz[1] = q.x();
  wxyz[2] = q.y();
  wxyz[3] = q.z();
}

void set_matrix(const Matrix6& from, double (&row_major)[36]) {
  for (int i = 0; i < 36; ++i) row_major[i] = from(i / 6, i % 6);
}

/// Seconds and nanoseconds of a stamp. Seconds are rounded down, so that nanoseconds are never negative.
std_msgs::Time time_of(std::int64_t utime) {
  const std::int64_t microseconds = (utime % 1000000 + 1000000) % 1000000;
  std_msgs::Time time;
  time.sec = static_cast<std::int32_t>((utime - microseconds) / 1000000);
  time.nsec = static_cast<std::int32_t>(microseconds * 1000);
  return time;
}

}  // namespace

Bytes encode_pose(const TrackedScan& tracked, TwistFrame twist_frame) {
  const Eigen::Matrix3d rotation = tracked.map_from_body.rotation();
  Eigen::Vector3d velocity = tracked.twist.head<3>(), rate = tracked.twist.tail<3>();
  if (twist_frame == TwistFrame::kLocal) {
    velocity = rotation * velocity;
    rate = rotation * rate;
  } else if (twist_frame == TwistFrame::kZero) {
    velocity.setZero();
    rate.setZero();
  }
  bot_core::pose_t message{};
  message.utime = tracked.utime;
  set_vector(tracked.map_from_body.translation(), message.pos);
  set_vector(velocity, message.vel);
  set_quaternion(tracked.map_from_body, message.orientation);
  set_vector(rate, message.rotation_rate);
  return generated_bytes(message);
}

Bytes encode_rigid_transform(const TrackedScan& tracked) {
  bot_core::rigid_transform_t message{};
  message.utime = tracked.utime;
  set_vector(tracked.map_from_body.translation(), message.trans);
  set_quaternion(tracked.map_from_body, message.quat);
  return generated_bytes(message);
}

Bytes encode_pose2d(const TrackedScan& tracked) {
  const Eigen::Matrix3d rotation = tracked.map_from_body.rotation();
  mbot_lcm_msgs::pose2D_t message{};
  message.utime = tracked.utime;
  message.x = static_cast<float>(tracked.map_from_body.translation().x());
  message.y = static_cast<float>(tracked.map_from_body.translation().y());
  message.theta = static_cast<float>(atan2(rotation(1, 0), rotation(0, 0)));
  return generated_bytes(message);
}

Bytes encode_nav_odometry(const TrackedScan& tracked, const std::string& frame_id,
                          const std::string& child_frame_id, std::int32_t seq) {
  nav_msgs::Odometry message{};
  message.header.seq = seq;
  message.header.stamp = time_of(tracked.utime);
  message.header.frame_id = wire_string(frame_id);
  message.child_frame_id = wire_string(child_frame_id);
  const Eigen::Vector3d position = tracked.map_from_body.translation();
  message.pose.pose.position.x = position.x();
  message.pose.pose.position.y = position.y();
  message.pose.pose.position.z = position.z();
  const Eigen::Quaterniond q = quaternion_of(tracked.map_from_body);
  message.pose.pose.orientation.x = q.x();
  message.pose.pose.orientation.y = q.y();
  message.pose.pose.orientation.z = q.z();
  message.pose.pose.orientation.w = q.w();
  // R exp(phi) = exp(R phi) R and p + R u: both halves of the perturbation are rotated by R.
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = tracked.map_from_body.rotation();
  set_matrix(turn * tracked.covariance * turn.transpose(), message.pose.covariance);
  message.twist.twist.linear.x = tracked.twist[0];
  message.twist.twist.linear.y = tracked.twist[1];
  message.twist.twist.linear.z = tracked.twist[2];
  message.twist.twist.angular.x = tracked.twist[3];
  message.twist.twist.angular.y = tracked.twist[4];
  message.twist.twist.angular.z = tracked.twist[5];
  message.twist.covariance[0] = -1;
  return generated_bytes(message);
}

Bytes encode_odometry(const TrackedScan& tracked, const OdometryContext& context) {
  odometry_t message{};
  message.utime = tracked.utime;
  message.recv_utime = context.recv_utime;
  message.pub_utime = context.pub_utime;
  message.seq = context.seq;
  message.scan_seq = context.scan_seq;
  message.frame_id = wire_string(context.frame_id);
  message.child_frame_id = wire_string(context.child_frame_id);
  set_vector(tracked.map_from_body.translation(), message.pos);
  set_quaternion(tracked.map_from_body, message.quat);
  set_vector(tracked.twist.head<3>(), message.vel);
  set_vector(tracked.twist.tail<3>(), message.rotation_rate);
  set_matrix(tracked.covariance, message.covariance);
  message.state = static_cast<std::int8_t>(tracked.state);
  message.method = static_cast<std::int8_t>(tracked.method);
  message.stop_reason = static_cast<std::int8_t>(tracked.stop_reason);
  message.epoch = static_cast<std::int32_t>(tracked.epoch);
  message.degenerate_axes = static_cast<std::int32_t>(tracked.degenerate_axes);
  message.iterations = tracked.iterations;
  message.points_in = tracked.points_in;
  message.points_used = tracked.points_used;
  message.inliers = tracked.inliers;
  message.keyframes = tracked.keyframes;
  message.map_points = tracked.map_points;
  message.energy = tracked.energy;
  message.energy_baseline = tracked.energy_baseline;
  message.energy_score = tracked.energy_score;
  message.age_ms = context.age_ms;
  message.decode_ms = context.times.decode_ms;
  message.wait_ms = context.times.wait_ms;
  message.preprocess_ms = context.times.preprocess_ms;
  message.align_ms = context.times.align_ms;
  message.map_ms = context.times.map_ms;
  message.total_ms = context.times.total_ms;
  return generated_bytes(message);
}

Bytes encode_status(const StatusReport& report) {
  status_t message{};
  message.utime = report.utime;
  message.uptime_us = report.uptime_us;
  message.version = wire_string(report.version);
  message.host = wire_string(report.host);
  message.state = static_cast<std::int8_t>(report.state);
  message.scans_received = report.scans_received;
  message.sectors_received = report.sectors_received;
  message.sectors_discarded = report.sectors_discarded;
  message.scans_used = report.scans_used;
  message.scans_replaced = report.scans_replaced;
  message.scans_incomplete = report.scans_incomplete;
  message.rejected_truncated = report.rejected_truncated;
  message.rejected_unknown_type = report.rejected_unknown_type;
  message.rejected_bad_size = report.rejected_bad_size;
  message.rejected_bad_field = report.rejected_bad_field;
  message.rejected_empty = report.rejected_empty;
  message.rejected_duplicate_time = report.rejected_duplicate_time;
  message.rejected_backward_time = report.rejected_backward_time;
  message.rejected_clock = report.rejected_clock;
  message.clock_steps = report.clock_steps;
  message.scans_without_time = report.scans_without_time;
  message.nonfinite_points = report.nonfinite_points;
  message.kernel_drops = report.kernel_drops;
  message.publish_errors = report.publish_errors;
  message.commands = report.commands;
  message.commands_rejected = report.commands_rejected;
  message.recoveries = report.recoveries;
  message.recovery_failures = report.recovery_failures;
  message.recv_buf_wanted = report.recv_buf_wanted;
  message.recv_buf_granted = report.recv_buf_granted;
  message.keyframes = report.keyframes;
  message.map_points = report.map_points;
  message.epoch = report.epoch;
  message.input_hz = report.input_hz;
  message.output_hz = report.output_hz;
  message.latency_p50_ms = report.latency_p50_ms;
  message.latency_p95_ms = report.latency_p95_ms;
  message.latency_p99_ms = report.latency_p99_ms;
  message.rss_mb = report.rss_mb;
  message.last_error_utime = report.last_error_utime;
  message.last_error = wire_string(report.last_error);
  return generated_bytes(message);
}

Bytes encode_recovery(const RecoveryReport& report) {
  recovery_t message{};
  message.utime = report.utime;
  message.seq = report.seq;
  message.epoch = report.epoch;
  set_vector(report.map_from_body.translation(), message.pos);
  set_quaternion(report.map_from_body, message.quat);
  set_vector(report.correction.translation(), message.correction_pos);
  set_quaternion(report.correction, message.correction_quat);
  message.energy_before = report.energy_before;
  message.energy_after = report.energy_after;
  message.matches = report.matches;
  message.matches_kept = report.matches_kept;
  message.consensus = report.consensus;
  message.upper_bound = report.upper_bound;
  message.runner_up_consensus = report.runner_up_consensus;
  message.certified = report.certified ? 1 : 0;
  message.accepted = report.accepted ? 1 : 0;
  message.reason = wire_string(report.reason);
  message.nodes = report.nodes;
  message.search_ms = report.search_ms;
  message.total_ms = report.total_ms;
  return generated_bytes(message);
}

Bytes encode_command(const Command& command) {
  command_t message{};
  message.utime = command.utime;
  message.command = static_cast<std::int8_t>(command.kind);
  set_vector(command.map_from_body.translation(), message.pos);
  set_quaternion(command.map_from_body, message.quat);
  message.path = wire_string(command.path);
  return generated_bytes(message);
}

}  // namespace scanlock
