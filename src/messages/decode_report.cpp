// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/decode_report.hpp"

#include <cmath>

#include "messages/byte_reader.hpp"
#include "messages/fingerprints.hpp"

namespace scanlock {
namespace {

std::string sentence(const char* type, const std::string& error) {
  return std::string(type) + ": " + error;
}

/// Runs `read` on the bytes after the fingerprint, which must be `type`.
template <typename Value, typename Read>
Decoded<Value> decode_as(std::uint64_t type, const std::uint8_t* data, std::size_t size, Read read) {
  Decoded<Value> decoded;
  const std::uint64_t found = message_fingerprint(data, size);
  if (found != type) {
    const bool too_short = data == nullptr || size < 8;
    decoded.fault = too_short ? DecodeFault::kTruncated : DecodeFault::kUnknownType;
    const char* name = type_name(found);
    decoded.error = sentence(type_name(type), too_short         ? "the message has fewer than eight bytes"
                                              : name != nullptr ? std::string("the message is a ") + name
                                                                : "the message is of an unknown type");
    return decoded;
  }
  ByteReader reader(data + 8, size - 8);
  read(reader, decoded.value);
  reader.expect_end();
  decoded.fault = reader.fault();
  if (!reader.ok()) decoded.error = sentence(type_name(type), reader.error());
  return decoded;
}

Eigen::Vector3d read_vector(ByteReader& reader, const char* member) {
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  reader.read_doubles(vector.data(), 3, member);
  if (reader.ok() && !vector.allFinite())
    reader.fail(DecodeFault::kBadField, std::string("`") + member + "` is not finite");
  return vector;
}

Eigen::Quaterniond checked_quaternion(ByteReader& reader, const char* member, double w, double x, double y,
                                      double z) {
  const Eigen::Quaterniond q(w, x, y, z);
  const double norm = q.norm();
  if (norm > 0.9 && norm < 1.1) return q.normalized();
  reader.fail(DecodeFault::kBadField,
              std::string("`") + member + "` is no unit quaternion: its length is " + std::to_string(norm));
  return Eigen::Quaterniond::Identity();
}

Eigen::Quaterniond read_quaternion_wxyz(ByteReader& reader, const char* member) {
  double q[4] = {1, 0, 0, 0};
  reader.read_doubles(q, 4, member);
  return checked_quaternion(reader, member, q[0], q[1], q[2], q[3]);
}

Pose read_pose(ByteReader& reader, const char* position, const char* orientation) {
  Pose pose = Pose::Identity();
  pose.translation() = read_vector(reader, position);
  pose.linear() = read_quaternion_wxyz(reader, orientation).toRotationMatrix();
  return pose;
}

template <typename Enum>
Enum read_enum(ByteReader& reader, const char* member, Enum last, Enum first = Enum{0}) {
  const std::int8_t number = reader.read_i8(member);
  if (number >= static_cast<std::int8_t>(first) && number <= static_cast<std::int8_t>(last))
    return static_cast<Enum>(number);
  reader.fail(DecodeFault::kBadField,
              std::string("`") + member + "` is " + std::to_string(number) + ", which is not defined");
  return first;
}

std::string text(ByteReader& reader, const char* member) {
  return std::string(reader.read_string(member));
}

void read_pose_t(ByteReader& reader, PoseReport& report) {
  double unused[3];
  report.utime = reader.read_i64("utime");
  const Eigen::Vector3d position = read_vector(reader, "pos");
  reader.read_doubles(unused, 3, "vel");
  const Eigen::Quaterniond q = read_quaternion_wxyz(reader, "orientation");
  reader.read_doubles(unused, 3, "rotation_rate");
  reader.read_doubles(unused, 3, "accel");
  report.map_from_body = Pose(Eigen::Translation3d(position) * q);
}

void read_rigid_transform(ByteReader& reader, PoseReport& report) {
  report.utime = reader.read_i64("utime");
  report.map_from_body = read_pose(reader, "trans", "quat");
}

void read_nav_odometry(ByteReader& reader, PoseReport& report) {
  reader.read_i32("header.seq");
  const std::int64_t seconds = reader.read_i32("header.stamp.sec");
  const std::int64_t nanoseconds = reader.read_i32("header.stamp.nsec");
  report.utime = seconds * 1000000 + nanoseconds / 1000;
  reader.read_string("header.frame_id");
  reader.read_string("child_frame_id");
  const Eigen::Vector3d position = read_vector(reader, "pose.pose.position");
  double xyzw[4] = {0, 0, 0, 1};
  reader.read_doubles(xyzw, 4, "pose.pose.orientation");
  const Eigen::Quaterniond q =
      checked_quaternion(reader, "pose.pose.orientation", xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  report.map_from_body = Pose(Eigen::Translation3d(position) * q);
  double unused[36];
  reader.read_doubles(unused, 36, "pose.covariance");
  reader.read_doubles(unused, 6, "twist.twist");
  reader.read_doubles(unused, 36, "twist.covariance");
}

void read_pose2d(ByteReader& reader, PoseReport& report) {
  report.utime = reader.read_i64("utime");
  const double x = static_cast<double>(reader.read_float("x")),
               y = static_cast<double>(reader.read_float("y"));
  const double theta = static_cast<double>(reader.read_float("theta"));
  if (reader.ok() && !(std::isfinite(x) && std::isfinite(y) && std::isfinite(theta)))
    return reader.fail(DecodeFault::kBadField, "`x`, `y` or `theta` is not finite");
  report.map_from_body.linear() = rotation_about_z(theta);
  report.map_from_body.translation() = Eigen::Vector3d(x, y, 0);
}

void read_odometry(ByteReader& reader, OdometryReport& report) {
  TrackedScan& tracked = report.tracked;
  OdometryContext& context = report.context;
  tracked.utime = reader.read_i64("utime");
  context.recv_utime = reader.read_i64("recv_utime");
  context.pub_utime = reader.read_i64("pub_utime");
  context.seq = reader.read_i64("seq");
  context.scan_seq = reader.read_i32("scan_seq");
  context.frame_id = text(reader, "frame_id");
  context.child_frame_id = text(reader, "child_frame_id");
  tracked.map_from_body = read_pose(reader, "pos", "quat");
  tracked.twist.head<3>() = read_vector(reader, "vel");
  tracked.twist.tail<3>() = read_vector(reader, "rotation_rate");
  for (int i = 0; i < 36; ++i) tracked.covariance(i / 6, i % 6) = reader.read_double("covariance");
  tracked.state = read_enum(reader, "state", TrackingState::kLost);
  tracked.method = read_enum(reader, "method", PoseMethod::kPredicted);
  tracked.stop_reason = read_enum(reader, "stop_reason", StopReason::kDiverged);
  tracked.epoch = static_cast<std::uint32_t>(reader.read_i32("epoch"));
  tracked.degenerate_axes = static_cast<std::uint32_t>(reader.read_i32("degenerate_axes"));
  tracked.iterations = reader.read_i32("iterations");
  tracked.points_in = reader.read_i32("points_in");
  tracked.points_used = reader.read_i32("points_used");
  tracked.inliers = reader.read_i32("inliers");
  tracked.keyframes = reader.read_i32("keyframes");
  tracked.map_points = reader.read_i32("map_points");
  tracked.energy = reader.read_double("energy");
  tracked.energy_baseline = reader.read_double("energy_baseline");
  tracked.energy_score = reader.read_double("energy_score");
  context.age_ms = reader.read_float("age_ms");
  context.times.decode_ms = reader.read_float("decode_ms");
  context.times.wait_ms = reader.read_float("wait_ms");
  context.times.preprocess_ms = reader.read_float("preprocess_ms");
  context.times.align_ms = reader.read_float("align_ms");
  context.times.map_ms = reader.read_float("map_ms");
  context.times.total_ms = reader.read_float("total_ms");
}

void read_status(ByteReader& reader, StatusReport& report) {
  report.utime = reader.read_i64("utime");
  report.uptime_us = reader.read_i64("uptime_us");
  report.version = text(reader, "version");
  report.host = text(reader, "host");
  report.state = read_enum(reader, "state", TrackingState::kLost);
  report.scans_received = reader.read_i64("scans_received");
  report.sectors_received = reader.read_i64("sectors_received");
  report.sectors_discarded = reader.read_i64("sectors_discarded");
  report.scans_used = reader.read_i64("scans_used");
  report.scans_replaced = reader.read_i64("scans_replaced");
  report.scans_incomplete = reader.read_i64("scans_incomplete");
  report.rejected_truncated = reader.read_i64("rejected_truncated");
  report.rejected_unknown_type = reader.read_i64("rejected_unknown_type");
  report.rejected_bad_size = reader.read_i64("rejected_bad_size");
  report.rejected_bad_field = reader.read_i64("rejected_bad_field");
  report.rejected_empty = reader.read_i64("rejected_empty");
  report.rejected_duplicate_time = reader.read_i64("rejected_duplicate_time");
  report.rejected_backward_time = reader.read_i64("rejected_backward_time");
  report.rejected_clock = reader.read_i64("rejected_clock");
  report.clock_steps = reader.read_i64("clock_steps");
  report.scans_without_time = reader.read_i64("scans_without_time");
  report.nonfinite_points = reader.read_i64("nonfinite_points");
  report.kernel_drops = reader.read_i64("kernel_drops");
  report.publish_errors = reader.read_i64("publish_errors");
  report.commands = reader.read_i64("commands");
  report.commands_rejected = reader.read_i64("commands_rejected");
  report.recoveries = reader.read_i64("recoveries");
  report.recovery_failures = reader.read_i64("recovery_failures");
  report.recv_buf_wanted = reader.read_i32("recv_buf_wanted");
  report.recv_buf_granted = reader.read_i32("recv_buf_granted");
  report.keyframes = reader.read_i32("keyframes");
  report.map_points = reader.read_i32("map_points");
  report.epoch = reader.read_i32("epoch");
  report.input_hz = reader.read_float("input_hz");
  report.output_hz = reader.read_float("output_hz");
  report.latency_p50_ms = reader.read_float("latency_p50_ms");
  report.latency_p95_ms = reader.read_float("latency_p95_ms");
  report.latency_p99_ms = reader.read_float("latency_p99_ms");
  report.rss_mb = reader.read_float("rss_mb");
  report.last_error_utime = reader.read_i64("last_error_utime");
  report.last_error = text(reader, "last_error");
}

void read_recovery(ByteReader& reader, RecoveryReport& report) {
  report.utime = reader.read_i64("utime");
  report.seq = reader.read_i64("seq");
  report.epoch = reader.read_i32("epoch");
  report.map_from_body = read_pose(reader, "pos", "quat");
  report.correction = read_pose(reader, "correction_pos", "correction_quat");
  report.energy_before = reader.read_double("energy_before");
  report.energy_after = reader.read_double("energy_after");
  report.matches = reader.read_i32("matches");
  report.matches_kept = reader.read_i32("matches_kept");
  report.consensus = reader.read_i32("consensus");
  report.upper_bound = reader.read_double("upper_bound");
  report.runner_up_consensus = reader.read_i32("runner_up_consensus");
  report.certified = reader.read_u8("certified") != 0;
  report.accepted = reader.read_u8("accepted") != 0;
  report.reason = text(reader, "reason");
  report.nodes = reader.read_i64("nodes");
  report.search_ms = reader.read_float("search_ms");
  report.total_ms = reader.read_float("total_ms");
}

}  // namespace

Decoded<PoseReport> decode_pose(const std::uint8_t* data, std::size_t size) {
  const std::uint64_t type = message_fingerprint(data, size);
  Decoded<PoseReport> decoded;
  switch (type) {
    case fingerprint::kRigidTransform:
      decoded = decode_as<PoseReport>(type, data, size, read_rigid_transform);
      break;
    case fingerprint::kNavOdometry:
      decoded = decode_as<PoseReport>(type, data, size, read_nav_odometry);
      break;
    case fingerprint::kPose2d:
      decoded = decode_as<PoseReport>(type, data, size, read_pose2d);
      break;
    case fingerprint::kOdometry: {
      const Decoded<OdometryReport> odometry = decode_odometry(data, size);
      decoded.fault = odometry.fault;
      decoded.error = odometry.error;
      const TrackedScan& tracked = odometry.value.tracked;
      decoded.value = {{}, tracked.utime, tracked.map_from_body, tracked.state};
      break;
    }
    default:
      decoded = decode_as<PoseReport>(fingerprint::kPose, data, size, read_pose_t);
      break;
  }
  if (const char* name = type_name(type)) decoded.value.type = name;
  return decoded;
}

Decoded<OdometryReport> decode_odometry(const std::uint8_t* data, std::size_t size) {
  return decode_as<OdometryReport>(fingerprint::kOdometry, data, size, read_odometry);
}

Decoded<StatusReport> decode_status(const std::uint8_t* data, std::size_t size) {
  return decode_as<StatusReport>(fingerprint::kStatus, data, size, read_status);
}

Decoded<RecoveryReport> decode_recovery(const std::uint8_t* data, std::size_t size) {
  return decode_as<RecoveryReport>(fingerprint::kRecovery, data, size, read_recovery);
}

Decoded<Command> decode_command(const std::uint8_t* data, std::size_t size) {
  return decode_as<Command>(fingerprint::kCommand, data, size, [](ByteReader& reader, Command& command) {
    command.utime = reader.read_i64("utime");
    command.kind = read_enum(reader, "command", CommandKind::kLoadMap, CommandKind::kSetPose);
    if (command.kind == CommandKind::kSetPose) {
      command.map_from_body = read_pose(reader, "pos", "quat");
      constexpr double kFarthest = 1e7;  // metres: pole to equator, far beyond any map
      if (!(command.map_from_body.translation().norm() <= kFarthest))
        reader.fail(DecodeFault::kBadField, "`pos` is over 10000 km from the map's origin");
    } else {  // other commands do not use the pose, and senders leave it zero
      double unused[7];
      reader.read_doubles(unused, 7, "pos or quat");
    }
    command.path = text(reader, "path");
  });
}

Decoded<AttitudeReport> decode_attitude(const std::uint8_t* data, std::size_t size) {
  return decode_as<AttitudeReport>(fingerprint::kIns, data, size,
                                   [](ByteReader& reader, AttitudeReport& report) {
                                     double unused[3];
                                     report.utime = reader.read_i64("utime");
                                     reader.read_i64("device_time");
                                     report.gyro = read_vector(reader, "gyro");
                                     reader.read_doubles(unused, 3, "mag");
                                     reader.read_doubles(unused, 3, "accel");
                                     report.local_from_body = read_quaternion_wxyz(reader, "quat");
                                     reader.read_doubles(unused, 2, "pressure or rel_alt");
                                   });
}

}  // namespace scanlock
