// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/encode.hpp"

#include <doctest/doctest.h>

#include <bot_core/pose_t.hpp>
#include <nav_msgs/Odometry.hpp>
#include <string>

#include "messages/decode_report.hpp"
#include "sample_reports.hpp"
#include "wire.hpp"

using namespace scanlock;

namespace {

std::string hex(const Bytes& bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) (text += kDigits[byte >> 4]) += kDigits[byte & 15];
  return text;
}

}  // namespace

TEST_CASE("golden bytes of bot_core pose_t") {
  TrackedScan tracked;
  tracked.utime = 0x0102030405060708;
  tracked.map_from_body.translation() = Eigen::Vector3d(1, 2, -0.5);
  tracked.twist << 4, 0, 0, 0, 0, 8;
  CHECK(hex(encode_pose(tracked, TwistFrame::kBody)) ==
        "2e16efb052b0105e"  // fingerprint
        "0102030405060708"  // utime
        "3ff0000000000000"
        "4000000000000000"
        "bfe0000000000000"  // pos
        "4010000000000000"
        "0000000000000000"
        "0000000000000000"  // vel
        "3ff0000000000000"
        "0000000000000000"
        "0000000000000000"
        "0000000000000000"  // orientation
        "0000000000000000"
        "0000000000000000"
        "4020000000000000"  // rotation_rate
        "0000000000000000"
        "0000000000000000"
        "0000000000000000");  // accel
}

TEST_CASE("golden bytes of scanlock command_t") {
  Command command;
  command.utime = 1;
  command.kind = CommandKind::kSaveMap;
  command.path = "m.ply";
  CHECK(hex(encode_command(command)) ==
        "12352c27f5965257"
        "0000000000000001"
        "03"
        "0000000000000000"
        "0000000000000000"
        "0000000000000000"
        "3ff0000000000000"
        "0000000000000000"
        "0000000000000000"
        "0000000000000000"
        "00000006"
        "6d2e706c7900");
}

TEST_CASE("the twist of pose_t is in the frame that was asked for") {
  TrackedScan tracked;
  tracked.map_from_body.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  tracked.twist << 10, 0, 0, 1, 0, 0;  // forward, and rolling
  const auto body = theirs<bot_core::pose_t>(encode_pose(tracked, TwistFrame::kBody));
  CHECK(body.vel[0] == doctest::Approx(10));
  CHECK(body.rotation_rate[0] == doctest::Approx(1));
  const auto local = theirs<bot_core::pose_t>(encode_pose(tracked, TwistFrame::kLocal));
  CHECK(local.vel[0] == doctest::Approx(0));
  CHECK(local.vel[1] == doctest::Approx(10));
  CHECK(local.rotation_rate[1] == doctest::Approx(1));
  const auto zero = theirs<bot_core::pose_t>(encode_pose(tracked, TwistFrame::kZero));
  CHECK(zero.vel[0] == 0);
  CHECK(zero.rotation_rate[0] == 0);
  CHECK(zero.orientation[0] == doctest::Approx(std::sqrt(0.5)));
  CHECK(zero.orientation[3] == doctest::Approx(std::sqrt(0.5)));
}

TEST_CASE(
    "nav_msgs Odometry has its quaternion x y z w, its stamp split, its covariance in the header frame") {
  TrackedScan tracked;
  tracked.utime = 1700000000123456;
  tracked.map_from_body.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  tracked.covariance.diagonal() << 1, 2, 3, 4, 5, 6;
  const auto message = theirs<nav_msgs::Odometry>(encode_nav_odometry(tracked, "map", "lidar", 9));
  CHECK(message.header.seq == 9);
  CHECK(message.header.stamp.sec == 1700000000);
  CHECK(message.header.stamp.nsec == 123456000);
  CHECK(message.header.frame_id == "map");
  CHECK(message.child_frame_id == "lidar");
  CHECK(message.pose.pose.orientation.z == doctest::Approx(std::sqrt(0.5)));
  CHECK(message.pose.pose.orientation.w == doctest::Approx(std::sqrt(0.5)));
  // The y axis of the body is the -x axis of the map.
  CHECK(message.pose.covariance[0] == doctest::Approx(2));
  CHECK(message.pose.covariance[7] == doctest::Approx(1));
  CHECK(message.pose.covariance[21] == doctest::Approx(5));
  CHECK(message.twist.covariance[0] == -1);
}

TEST_CASE("each pose type is decoded to the pose that was encoded") {
  const TrackedScan tracked = sample_tracked();
  const Bytes messages[] = {encode_pose(tracked, TwistFrame::kLocal), encode_rigid_transform(tracked),
                            encode_nav_odometry(tracked, "map", "body", 1), encode_odometry(tracked, {})};
  for (const Bytes& bytes : messages) {
    const auto decoded = decode_pose(bytes.data(), bytes.size());
    CAPTURE(decoded.value.type);
    REQUIRE(decoded.error == "");
    CHECK(decoded.value.utime == tracked.utime);
    CHECK(decoded.value.map_from_body.isApprox(tracked.map_from_body, 1e-12));
    CHECK(decoded.value.state.has_value() == (decoded.value.type == "scanlock.odometry_t"));
  }
}

TEST_CASE("pose2D keeps x, y and yaw") {
  TrackedScan tracked;
  tracked.utime = 5;
  tracked.map_from_body = Eigen::Translation3d(1, -2, 9) * Eigen::AngleAxisd(-2.5, Eigen::Vector3d::UnitZ());
  const Bytes bytes = encode_pose2d(tracked);
  const auto decoded = decode_pose(bytes.data(), bytes.size());
  REQUIRE(decoded.error == "");
  CHECK(decoded.value.type == "mbot_lcm_msgs.pose2D_t");
  CHECK(decoded.value.map_from_body.translation().isApprox(Eigen::Vector3d(1, -2, 0), 1e-6));
  CHECK(so3_log(decoded.value.map_from_body.rotation()).z() == doctest::Approx(-2.5));
}

TEST_CASE("equal rotations give equal bytes") {
  TrackedScan one = sample_tracked(), two = one;
  two.map_from_body.linear() =
      Eigen::Quaterniond(-Eigen::Quaterniond(one.map_from_body.rotation()).coeffs()).toRotationMatrix();
  CHECK(theirs<bot_core::pose_t>(encode_pose(one, TwistFrame::kZero)).orientation[0] >= 0);
  CHECK(theirs<bot_core::pose_t>(encode_pose(two, TwistFrame::kZero)).orientation[0] >= 0);
}
