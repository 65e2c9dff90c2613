// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/decode_report.hpp"

#include <doctest/doctest.h>

#include <bot_core/ins_t.hpp>
#include <bot_core/pose_t.hpp>
#include <limits>
#include <scanlock/odometry_t.hpp>
#include <scanlock/recovery_t.hpp>
#include <scanlock/status_t.hpp>
#include <string>

#include "messages/encode.hpp"
#include "messages/generated_bytes.hpp"
#include "sample_reports.hpp"

using namespace scanlock;

// Decoding and encoding again must give the same bytes, and every member of the samples differs from its
// neighbours: with lcm-gen's decoding of some members, any swapped or lost member is found.
TEST_CASE("every member of odometry_t survives encoding and decoding") {
  const Bytes bytes = encode_odometry(sample_tracked(), sample_context());
  const auto decoded = decode_odometry(bytes.data(), bytes.size());
  REQUIRE(decoded.error == "");
  const TrackedScan& tracked = decoded.value.tracked;
  CHECK(tracked.state == TrackingState::kDegraded);
  CHECK(tracked.map_from_body.isApprox(sample_tracked().map_from_body, 1e-12));
  CHECK(tracked.covariance == sample_tracked().covariance);
  CHECK(tracked.inliers == 14);
  CHECK(tracked.energy_score == 17.5);
  CHECK(decoded.value.context.times.total_ms == 11.5f);

  odometry_t theirs;
  REQUIRE(theirs.decode(bytes.data(), 0, static_cast<int>(bytes.size())) == static_cast<int>(bytes.size()));
  CHECK(theirs.recv_utime == 1);
  CHECK(theirs.pub_utime == 2);
  CHECK(theirs.child_frame_id == "lidar");
  CHECK(theirs.covariance[7] == 3.5);
  CHECK(theirs.state == odometry_t::DEGRADED);
  CHECK(theirs.stop_reason == odometry_t::STOP_ITERATIONS);
  CHECK(theirs.epoch == 4);
  CHECK(theirs.iterations == 11);
  CHECK(theirs.points_used == 13);
  CHECK(theirs.map_points == 19);
  CHECK(theirs.energy_baseline == 0.16);
  CHECK(theirs.age_ms == 5.5f);
  CHECK(theirs.align_ms == 9.5f);
}

TEST_CASE("status_t and recovery_t survive encoding and decoding") {
  const Bytes status = encode_status(sample_status());
  const auto decoded_status = decode_status(status.data(), status.size());
  REQUIRE(decoded_status.error == "");
  CHECK(encode_status(decoded_status.value) == status);
  status_t theirs;
  REQUIRE(theirs.decode(status.data(), 0, static_cast<int>(status.size())) ==
          static_cast<int>(status.size()));
  CHECK(theirs.scans_received == 102);
  CHECK(theirs.kernel_drops == 119);
  CHECK(theirs.recv_buf_granted == 1001);
  CHECK(theirs.latency_p99_ms == 4.5f);
  CHECK(theirs.last_error == "LIDAR: the message ends within `data`");

  const Bytes recovery = encode_recovery(sample_recovery());
  const auto decoded_recovery = decode_recovery(recovery.data(), recovery.size());
  REQUIRE(decoded_recovery.error == "");
  CHECK(decoded_recovery.value.map_from_body.isApprox(sample_recovery().map_from_body, 1e-12));
  CHECK(decoded_recovery.value.correction.isApprox(sample_recovery().correction, 1e-12));
  CHECK(decoded_recovery.value.reason == "two places are alike");
  recovery_t their_recovery;
  REQUIRE(their_recovery.decode(recovery.data(), 0, static_cast<int>(recovery.size())) ==
          static_cast<int>(recovery.size()));
  CHECK(their_recovery.certified == 1);
  CHECK(their_recovery.accepted == 0);
  CHECK(their_recovery.consensus == 200);
  CHECK(their_recovery.runner_up_consensus == 50);
}

TEST_CASE("commands are decoded, and their quaternion is checked only where the command has a pose") {
  Command command;
  command.kind = CommandKind::kSetPose;
  command.map_from_body = sample_tracked().map_from_body;
  Bytes bytes = encode_command(command);
  auto decoded = decode_command(bytes.data(), bytes.size());
  REQUIRE(decoded.error == "");
  CHECK(decoded.value.map_from_body.isApprox(command.map_from_body, 1e-12));

  const std::size_t kind_at = 16, quaternion_at = 17 + 24;
  for (std::size_t i = 0; i < 32; ++i) bytes[quaternion_at + i] = 0;
  decoded = decode_command(bytes.data(), bytes.size());
  CHECK(decoded.fault == DecodeFault::kBadField);
  CHECK(decoded.error.find("`quat` is no unit quaternion") != std::string::npos);
  bytes[kind_at] = 2;
  CHECK(decode_command(bytes.data(), bytes.size()).ok());
  for (const std::uint8_t unknown : std::initializer_list<std::uint8_t>{0, 5, 255}) {
    bytes[kind_at] = unknown;
    CHECK(decode_command(bytes.data(), bytes.size()).fault == DecodeFault::kBadField);
  }
}

TEST_CASE("an attitude is decoded from ins_t") {
  bot_core::ins_t message{};
  message.utime = 77;
  message.quat[0] = message.quat[3] = std::sqrt(0.5);
  message.gyro[2] = 0.25;
  Bytes bytes = generated_bytes(message);
  const auto decoded = decode_attitude(bytes.data(), bytes.size());
  REQUIRE(decoded.error == "");
  CHECK(decoded.value.utime == 77);
  CHECK(decoded.value.gyro.z() == 0.25);
  CHECK(decoded.value.local_from_body.angularDistance(
            Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()))) < 1e-7);
}

TEST_CASE("an invalid pose is a fault that names the member") {
  bot_core::pose_t good{};
  good.orientation[0] = 1;
  const auto fault_of = [](const bot_core::pose_t& message) {
    const Bytes bytes = generated_bytes(message);
    return decode_pose(bytes.data(), bytes.size()).error;
  };
  CHECK(fault_of(good) == "");
  bot_core::pose_t bad = good;
  bad.pos[1] = std::numeric_limits<double>::quiet_NaN();
  CHECK(fault_of(bad) == "bot_core.pose_t: `pos` is not finite");
  bad = good;
  bad.orientation[0] = 0;
  CHECK(fault_of(bad).find("`orientation`") != std::string::npos);

  Bytes bytes = generated_bytes(good);
  bytes.push_back(0);
  CHECK(decode_pose(bytes.data(), bytes.size()).fault == DecodeFault::kTruncated);
  CHECK(decode_odometry(bytes.data(), bytes.size()).error ==
        "scanlock.odometry_t: the message is a bot_core.pose_t");
  CHECK(decode_pose(nullptr, 0).fault == DecodeFault::kTruncated);
}
