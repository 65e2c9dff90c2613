// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/prior_intake.hpp"

#include <doctest/doctest.h>

#include <bot_core/ins_t.hpp>
#include <cmath>
#include <limits>

#include "messages/encode.hpp"

using namespace scanlock;

namespace {

constexpr std::int64_t kFirstSample = 1700000000000000;

Bytes attitude(std::int64_t utime, double roll) {
  bot_core::ins_t message{};
  message.utime = utime;
  message.quat[0] = std::cos(roll / 2);
  message.quat[1] = std::sin(roll / 2);
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

Bytes odometry(std::int64_t utime, double x) {
  TrackedScan tracked;
  tracked.utime = utime;
  tracked.map_from_body.translation().x() = x;
  return encode_pose(tracked, TwistFrame::kZero);
}

PriorIntake both() {
  DaemonConfig config;
  config.attitude_channel = "IMU";
  config.prior_odometry_channel = "WHEELS";
  return PriorIntake(config);
}

std::optional<std::string> give(PriorIntake& intake, const std::string& channel, const Bytes& bytes) {
  return intake.take(channel, bytes.data(), bytes.size());
}

}  // namespace

TEST_CASE("without prior channels there is neither a sample nor a fault") {
  PriorIntake intake{DaemonConfig{}};
  CHECK(intake.channels().empty());
  for (int i = 0; i < 100; ++i) {
    const auto reading = intake.read(kFirstSample + i);
    CHECK_FALSE(reading.sample.odometry);
    CHECK_FALSE(reading.sample.level_from_body);
    CHECK(reading.fault.empty());
  }
}

TEST_CASE("both sensors are read at the stamp of the scan") {
  PriorIntake intake = both();
  CHECK(intake.channels() == std::vector<std::string>{"IMU", "WHEELS"});
  for (int i = 0; i < 10; ++i) {
    CHECK_FALSE(give(intake, "IMU", attitude(kFirstSample + 10000 * i, 0.01 * i)));
    CHECK_FALSE(give(intake, "WHEELS", odometry(kFirstSample + 10000 * i, 0.1 * i)));
  }
  const auto reading = intake.read(kFirstSample + 45000);
  CHECK(reading.fault.empty());
  REQUIRE(reading.sample.odometry);
  CHECK(reading.sample.odometry->translation().x() == doctest::Approx(0.45));
  REQUIRE(reading.sample.level_from_body);
  CHECK(Eigen::AngleAxisd(*reading.sample.level_from_body).angle() == doctest::Approx(0.045));
}

TEST_CASE("invalid messages are reported and change no sample") {
  PriorIntake intake = both();
  give(intake, "WHEELS", odometry(kFirstSample, 1));
  const auto wrong_type = give(intake, "WHEELS", attitude(kFirstSample + 1000, 0));
  REQUIRE(wrong_type);
  CHECK(wrong_type->find("WHEELS: ") == 0);
  CHECK(give(intake, "WHEELS", odometry(kFirstSample + 1000, std::numeric_limits<double>::quiet_NaN())));
  CHECK(give(intake, "WHEELS", odometry(kFirstSample - 1000, 7)));
  CHECK(give(intake, "IMU", {1, 2, 3}));
  CHECK_FALSE(give(intake, "OTHER", {1, 2, 3}));
  CHECK(intake.read(kFirstSample).sample.odometry->translation().x() == 1);
}

TEST_CASE("a sensor that is silent or stale or on another clock is reported by name") {
  PriorIntake intake = both();
  std::string fault;
  for (int i = 0; i < 30; ++i) fault = intake.read(kFirstSample + 100000 * i).fault;
  CHECK(fault.find("IMU: nothing came") != std::string::npos);
  CHECK(fault.find("WHEELS: nothing came") != std::string::npos);
  give(intake, "WHEELS", odometry(kFirstSample + 3000000, 1));
  fault = intake.read(kFirstSample + 3500000).fault;
  CHECK(fault.find("WHEELS: nothing near the scan") != std::string::npos);
  CHECK(fault.find("0.50 s behind") != std::string::npos);
  give(intake, "WHEELS", odometry(kFirstSample + 63500000, 1));
  const auto shifted = intake.read(kFirstSample + 3600000);
  CHECK_FALSE(shifted.sample.odometry);
  CHECK(shifted.fault.find("59.90 s ahead") != std::string::npos);
}
