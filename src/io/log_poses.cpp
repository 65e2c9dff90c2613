// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/log_poses.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

#include "io/lcm_log.hpp"
#include "messages/byte_reader.hpp"
#include "messages/fingerprints.hpp"

namespace scanlock {
namespace {

/// The fields that all pose types have.
struct RawPose {
  double time_s = 0;
  std::array<double, 3> position{};
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

double seconds(std::int64_t utime) {
  return static_cast<double>(utime) * 1e-6;
}

Eigen::Quaterniond read_wxyz(ByteReader& reader, const char* member) {
  std::array<double, 4> q{};
  reader.read_doubles(q.data(), q.size(), member);
  return {q[0], q[1], q[2], q[3]};
}

void read_pose_t(ByteReader& reader, RawPose& pose) {
  pose.time_s = seconds(reader.read_i64("utime"));
  reader.read_doubles(pose.position.data(), 3, "pos");
  std::array<double, 6> unused{};
  reader.read_doubles(unused.data(), 3, "vel");
  pose.rotation = read_wxyz(reader, "orientation");
  reader.read_doubles(unused.data(), 6, "rotation_rate and accel");
  reader.expect_end();
}

void read_rigid_transform(ByteReader& reader, RawPose& pose) {
  pose.time_s = seconds(reader.read_i64("utime"));
  reader.read_doubles(pose.position.data(), 3, "trans");
  pose.rotation = read_wxyz(reader, "quat");
  reader.expect_end();
}

void read_pose2d(ByteReader& reader, RawPose& pose) {
  pose.time_s = seconds(reader.read_i64("utime"));
  pose.position[0] = reader.read_float("x");
  pose.position[1] = reader.read_float("y");
  const double theta = reader.read_float("theta");
  pose.rotation = rotation_about_z(theta);
  reader.expect_end();
}

void read_nav_odometry(ByteReader& reader, RawPose& pose) {
  reader.read_i32("header.seq");
  const double sec = reader.read_i32("header.stamp.sec");
  pose.time_s = sec + 1e-9 * reader.read_i32("header.stamp.nsec");
  reader.read_string("header.frame_id");
  reader.read_string("child_frame_id");
  reader.read_doubles(pose.position.data(), 3, "pose.position");
  std::array<double, 4> xyzw{};
  reader.read_doubles(xyzw.data(), 4, "pose.orientation");
  pose.rotation = Eigen::Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
}

void read_odometry(ByteReader& reader, RawPose& pose) {
  pose.time_s = seconds(reader.read_i64("utime"));
  for (const char* member : {"recv_utime", "pub_utime", "seq"}) reader.read_i64(member);
  reader.read_i32("scan_seq");
  reader.read_string("frame_id");
  reader.read_string("child_frame_id");
  reader.read_doubles(pose.position.data(), 3, "pos");
  pose.rotation = read_wxyz(reader, "quat");
}

}  // namespace

std::optional<StampedPose> decode_pose(const std::uint8_t* data, std::size_t size, std::string& error) {
  ByteReader reader(data, size);
  const auto type = static_cast<std::uint64_t>(reader.read_i64("fingerprint"));
  RawPose raw;
  switch (type) {
    case fingerprint::kPose:
      read_pose_t(reader, raw);
      break;
    case fingerprint::kRigidTransform:
      read_rigid_transform(reader, raw);
      break;
    case fingerprint::kPose2d:
      read_pose2d(reader, raw);
      break;
    case fingerprint::kNavOdometry:
      read_nav_odometry(reader, raw);
      break;
    case fingerprint::kOdometry:
      read_odometry(reader, raw);
      break;
    default:
      reader.fail(DecodeFault::kUnknownType, "the message type is not a known pose type");
  }
  const Eigen::Vector3d position(raw.position[0], raw.position[1], raw.position[2]);
  if (reader.ok() && !position.allFinite()) reader.fail(DecodeFault::kBadField, "the position is not finite");
  if (reader.ok() && !(std::abs(raw.rotation.norm() - 1) <= kQuaternionTolerance))
    reader.fail(DecodeFault::kBadField, "the quaternion does not have length 1");
  if (!reader.ok()) {
    error = reader.error();
    return std::nullopt;
  }
  StampedPose stamped;
  stamped.time_s = raw.time_s;
  stamped.pose.linear() = raw.rotation.normalized().toRotationMatrix();
  stamped.pose.translation() = position;
  return stamped;
}

LogPoses read_log_poses(const std::string& path, const std::string& channel) {
  LogReader reader(path);
  LogPoses result;
  std::set<std::string> channels;
  while (const auto event = reader.next()) {
    channels.insert(event->channel);
    if (event->channel != channel) continue;
    std::string error;
    if (const auto stamped = decode_pose(event->data.data(), event->data.size(), error))
      result.trajectory.push_back(*stamped);
    else if (result.rejected++ == 0)
      result.first_error = error;
  }
  result.damage = damage_sentence(reader);
  if (!result.trajectory.empty()) return result;
  if (result.rejected > 0)
    throw std::runtime_error(path + ": channel " + channel + " holds no pose: " + result.first_error);
  std::string names;
  for (const std::string& name : channels) names += " " + name;
  throw std::runtime_error(path + ": nothing on channel " + channel + "; the log has" +
                           (names.empty() ? " no events" : names));
}

bool is_log(const std::string& path) {
  if (std::filesystem::path(path).extension() == ".lcmlog") return true;
  if (!std::filesystem::is_regular_file(path)) return false;  // opening a pipe without a writer would block
  std::ifstream file(path, std::ios::binary);
  std::array<char, 4> start{};
  return file.read(start.data(), start.size()) && std::string(start.data(), 4) == "\xED\xA1\xDA\x01";
}

std::string damage_sentence(const LogReader& reader) {
  std::string sentence;
  if (reader.damaged_places() > 0)
    sentence = "damaged at " + std::to_string(reader.damaged_places()) + " place(s), " +
               std::to_string(reader.skipped_bytes()) + " bytes skipped";
  if (reader.truncated())
    sentence += std::string(sentence.empty() ? "" : "; ") + "its last event is cut short";
  return sentence;
}

}  // namespace scanlock
