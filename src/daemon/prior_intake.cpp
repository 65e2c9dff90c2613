// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/prior_intake.hpp"

#include "messages/decode_report.hpp"

namespace scanlock {
namespace {

constexpr int kPatience = 20;  // scans without any message before a sensor is reported as missing

std::optional<std::string> complaint(const std::string& channel, PriorBuffer::Addition addition,
                                     std::int64_t utime) {
  switch (addition) {
    case PriorBuffer::Addition::kTaken:
    case PriorBuffer::Addition::kRestarted:
      return std::nullopt;
    case PriorBuffer::Addition::kBackward:
      return channel + ": utime " + std::to_string(utime) +
             " is not after that of the previous message; ignored";
    case PriorBuffer::Addition::kNotFinite:
      return channel + ": the pose is not finite; ignored";
  }
  return std::nullopt;
}

}  // namespace

PriorIntake::PriorIntake(const DaemonConfig& config)
    : attitude_{config.attitude_channel, {}, 0}, odometry_{config.prior_odometry_channel, {}, 0} {}

std::vector<std::string> PriorIntake::channels() const {
  std::vector<std::string> names;
  for (const Source* source : {&attitude_, &odometry_})
    if (!source->channel.empty()) names.push_back(source->channel);
  return names;
}

std::optional<std::string> PriorIntake::take(const std::string& channel, const std::uint8_t* data,
                                             std::size_t size) {
  if (channel.empty()) return std::nullopt;
  if (channel == attitude_.channel) {
    const auto decoded = decode_attitude(data, size);
    if (!decoded.ok()) return channel + ": " + decoded.error;
    Pose pose = Pose::Identity();
    pose.linear() = decoded.value.local_from_body.toRotationMatrix();
    return complaint(channel, attitude_.buffer.add(decoded.value.utime, pose), decoded.value.utime);
  }
  if (channel == odometry_.channel) {
    const auto decoded = decode_pose(data, size);
    if (!decoded.ok()) return channel + ": " + decoded.error;
    return complaint(channel, odometry_.buffer.add(decoded.value.utime, decoded.value.map_from_body),
                     decoded.value.utime);
  }
  return std::nullopt;
}

std::optional<Pose> PriorIntake::read(Source& source, std::int64_t scan_utime, std::string& fault) {
  if (source.channel.empty()) return std::nullopt;
  const PriorBuffer::Answer answer = source.buffer.at(scan_utime);
  std::string sentence;
  switch (answer.absence) {
    case PriorBuffer::Absence::kNone:
      return answer.pose;
    case PriorBuffer::Absence::kNever:
      if (++source.scans_without_any < kPatience) return std::nullopt;
      sentence = "nothing came on this channel so far";
      break;
    case PriorBuffer::Absence::kStale:
      sentence = "nothing near the scan of utime " + std::to_string(scan_utime) + ", the newest message is " +
                 offset_words(answer.offset_s);
      break;
    case PriorBuffer::Absence::kShifted:
      sentence = "its stamps are " + offset_words(answer.offset_s) +
                 " of the scans'; the clocks differ, or the messages are late; ignored";
      break;
  }
  fault += (fault.empty() ? "" : "; ") + source.channel + ": " + sentence;
  return std::nullopt;
}

PriorIntake::Reading PriorIntake::read(std::int64_t scan_utime) {
  Reading reading;
  reading.sample.odometry = read(odometry_, scan_utime, reading.fault);
  if (const auto attitude = read(attitude_, scan_utime, reading.fault))
    reading.sample.level_from_body = Eigen::Quaterniond(attitude->linear());
  return reading;
}

}  // namespace scanlock
