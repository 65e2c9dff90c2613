// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/intake.hpp"

#include <doctest/doctest.h>

#include "../odometry/room.hpp"
#include "messages/encode.hpp"
#include "messages/encode_scan.hpp"

using namespace scanlock;

namespace {

constexpr std::int64_t kArrival = 5000000;

struct IntakeBench {
  Config config;
  Statistics statistics{[](LogLevel, const std::string&) {}};
  Intake intake{config.daemon, statistics};

  std::vector<Intake::Item> take(const std::string& channel, const Bytes& bytes) {
    return intake.take(channel, bytes.data(), bytes.size(), kArrival);
  }
  Counters counters() const { return statistics.report().counters; }
};

Scan hall(std::int64_t utime) {
  return hall_scan(Pose::Identity(), Vector6::Zero(), utime, 5, 0.1, 2000);
}

}  // namespace

TEST_CASE("a scan keeps its stamp and its points, and a message on another channel is ignored") {
  IntakeBench bench;
  const Bytes bytes = encode_pointcloud2(hall(1000000));
  CHECK(bench.take("ELSEWHERE", bytes).empty());
  CHECK(bench.counters().received == 0);
  const auto items = bench.take("LIDAR", bytes);
  REQUIRE(items.size() == 1);
  const auto& received = std::get<ReceivedScan>(items[0]);
  CHECK(received.scan.utime == 1000000);
  CHECK(received.scan.points.size() == 2000);
  CHECK_FALSE(received.scan.stamped_by_arrival);
  CHECK(received.recv_utime == kArrival);
  CHECK(bench.counters().received == 1);
}

TEST_CASE("a scan without a stamp takes the time of its event") {
  IntakeBench bench;
  const auto items = bench.take("LIDAR", encode_pointcloud2(hall(0)));
  REQUIRE(items.size() == 1);
  CHECK(std::get<ReceivedScan>(items[0]).scan.utime == kArrival);
  CHECK(std::get<ReceivedScan>(items[0]).scan.stamped_by_arrival);
  CHECK(bench.counters().without_time == 1);
}

TEST_CASE("complete scans, received sectors and discarded sectors are counted separately") {
  IntakeBench bench;
  const std::vector<Bytes> sectors = encode_sectors(hall(1000000), {}, 6000);
  REQUIRE(sectors.size() > 2);
  std::size_t scans = 0;
  for (const Bytes& sector : sectors) scans += bench.take("LIDAR", sector).size();
  CHECK(scans == 1);
  CHECK(bench.counters().received == 1);
  CHECK(bench.counters().sectors == static_cast<std::int64_t>(sectors.size()));
  CHECK(bench.take("LIDAR", sectors[1]).empty());
  CHECK(bench.counters().sectors_discarded == 1);
  CHECK(bench.counters().last_error.find("its scan was passed on already") != std::string::npos);
}

TEST_CASE("scans without times of points are counted and warned of once a channel") {
  IntakeBench bench;
  Scan scan = hall(1000000);
  scan.points.time.clear();
  for (int i = 0; i < 3; ++i) bench.take("LIDAR", encode_pointcloud2(scan));
  CHECK(bench.counters().without_point_times == 3);
  CHECK(bench.statistics.first_complaint(&Counters::without_point_times).find("less accurate") !=
        std::string::npos);
}

TEST_CASE("commands are decoded, and invalid ones are counted") {
  IntakeBench bench;
  Command command;
  command.kind = CommandKind::kReset;
  const auto items = bench.take("SCANLOCK_COMMAND", encode_command(command));
  REQUIRE(items.size() == 1);
  CHECK(std::get<Command>(items[0]).kind == CommandKind::kReset);
  CHECK(bench.take("SCANLOCK_COMMAND", {1, 2, 3}).empty());
  CHECK(bench.counters().commands_rejected == 1);
}

TEST_CASE("a pose that is set beyond ten thousand kilometres is refused") {
  IntakeBench bench;
  Command command;
  command.kind = CommandKind::kSetPose;
  command.map_from_body.translation().x() = 1.1e7;
  CHECK(bench.take("SCANLOCK_COMMAND", encode_command(command)).empty());
  CHECK(bench.counters().last_error.find("10000 km") != std::string::npos);
  command.map_from_body.translation().x() = -0.9e7;
  CHECK(bench.take("SCANLOCK_COMMAND", encode_command(command)).size() == 1);
}
