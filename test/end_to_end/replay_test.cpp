// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <bot_core/planar_lidar_t.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <scanlock/command_t.hpp>
#include <scanlock/odometry_t.hpp>
#include <scanlock/status_t.hpp>

#include "../contains.hpp"
#include "io/log_poses.hpp"
#include "process.hpp"
#include "synthetic.hpp"

using namespace scanlock::test;

namespace {

constexpr int kScans = 30;
constexpr std::int64_t kSecond = 1000000;

/// Scan i of the drive as an event, stamped with `utime`; the time of the event is the true time of the scan.
Event scan_event(int i, std::int64_t utime) {
  return {utime_of(i), "LIDAR", bytes_of(scan_from(place_on_drive(i), utime, 16, 600))};
}

std::vector<Event> short_drive(int scans = kScans) {
  std::vector<Event> events;
  for (int i = 0; i < scans; ++i) events.push_back(scan_event(i, utime_of(i)));
  return events;
}

/// The output of scanlock-odometry for these events.
struct Outcome {
  Result result;
  nlohmann::json json;
  std::vector<scanlock::odometry_t> odometry;
  scanlock::status_t status{};  // the last status
};

Outcome replay(const std::vector<Event>& events, const std::string& config = "") {
  const TemporaryFolder folder;
  write_log(folder / "in.lcmlog", events);
  write_file(folder / "robot.toml", config);
  Outcome outcome;
  outcome.result = run(folder, {"scanlock-odometry", folder / "in.lcmlog", "-c", folder / "robot.toml",
                                "--output", folder / "out.lcmlog", "--json"});
  if (outcome.result.code == 0) outcome.json = nlohmann::json::parse(outcome.result.output);
  for (const Event& event : read_log(folder / "out.lcmlog")) {
    if (event.channel == "SCANLOCK_ODOMETRY")
      outcome.odometry.push_back(decoded<scanlock::odometry_t>(event));
    if (event.channel == "SCANLOCK_STATUS") outcome.status = decoded<scanlock::status_t>(event);
  }
  return outcome;
}

/// The position error, metres, at scan i of the drive, relative to the first scan.
double metres_off(const scanlock::odometry_t& pose, int i) {
  const Place begin = place_on_drive(0), now = place_on_drive(i);
  const double dx = now.x - begin.x, dy = now.y - begin.y;
  const double c = std::cos(begin.yaw), s = std::sin(begin.yaw);
  return std::hypot(pose.pos[0] - (c * dx + s * dy), pose.pos[1] - (c * dy - s * dx));
}

}  // namespace

TEST_CASE("a single wrong stamp costs its scan and nothing else") {
  const int off = 15;
  for (const std::int64_t utime : {std::int64_t{0}, std::int64_t{1}, std::int64_t{1} << 62,
                                   utime_of(off) + 3600 * kSecond, utime_of(off) - 3 * kSecond}) {
    CAPTURE(utime);
    std::vector<Event> events = short_drive();
    events[off] = scan_event(off, utime);
    const Outcome outcome = replay(events);
    REQUIRE(outcome.result.code == 0);
    CHECK(outcome.json["rejected_clock"] == 1);
    CHECK(outcome.status.rejected_clock == 1);
    CHECK(contains(outcome.result.errors, "scans rejected"));
    REQUIRE(outcome.odometry.size() == kScans - 1);
    for (const scanlock::odometry_t& pose : outcome.odometry) {
      const int i = static_cast<int>((pose.utime - utime_of(0)) / 100000);
      CHECK(i != off);
      CHECK(pose.epoch == 0);
      CHECK(metres_off(pose, i) < 0.1);
      if (i > 0) CHECK(pose.state == scanlock::odometry_t::TRACKING);
    }
  }
}

TEST_CASE("a clock step costs two scans, keeps map and epoch, and is reported") {
  const int step = 15;
  for (const std::int64_t by : {-kSecond / 2, -5 * kSecond, -utime_of(0) + kSecond, 86400 * kSecond}) {
    CAPTURE(by);
    std::vector<Event> events;
    for (int i = 0; i < kScans; ++i) events.push_back(scan_event(i, utime_of(i) + (i < step ? 0 : by)));
    const Outcome outcome = replay(events);
    REQUIRE(outcome.result.code == 0);
    CHECK(outcome.json["clock_steps"] == 1);
    CHECK(outcome.status.clock_steps == 1);
    CHECK(contains(outcome.result.errors, std::to_string(utime_of(step - 1))));
    CHECK(contains(outcome.result.errors, std::to_string(utime_of(step + 2) + by)));
    REQUIRE(outcome.odometry.size() == kScans - 2);
    CHECK(outcome.odometry.back().epoch == 0);
    CHECK(outcome.odometry.back().state == scanlock::odometry_t::TRACKING);
    CHECK(metres_off(outcome.odometry.back(), kScans - 1) < 0.1);
  }
}

TEST_CASE("scans without stamps take the times of their events") {
  std::vector<Event> events;
  for (int i = 0; i < 10; ++i) events.push_back(scan_event(i, 0));
  const Outcome outcome = replay(events);
  REQUIRE(outcome.result.code == 0);
  REQUIRE(outcome.odometry.size() == 10);
  for (int i = 0; i < 10; ++i) CHECK(outcome.odometry[static_cast<std::size_t>(i)].utime == utime_of(i));
  CHECK(outcome.status.scans_without_time == 10);
}

TEST_CASE("two publishers on one channel are detected by their clocks and by their poses") {
  std::vector<Event> clocks = short_drive(), places = short_drive();
  for (int i = 0; i < kScans; ++i) {
    // Scans of another drive, 30 m aside and turned, between the scans of the first drive.
    const Place aside{place_on_drive(i).x + 30, place_on_drive(i).y - 200, 1.3};
    const auto between = [&](std::int64_t utime) -> Event {
      return {utime_of(i) + kSecond / 20, "LIDAR", bytes_of(scan_from(aside, utime, 16, 600))};
    };
    clocks.insert(clocks.begin() + 2 * i + 1, between(utime_of(i) + 12 * kSecond));
    places.insert(places.begin() + 2 * i + 1, between(utime_of(i) + kSecond / 20));
  }
  CHECK(contains(replay(clocks).result.errors,
                 "two publishers send scans here: their stamps alternate between two clocks"));
  CHECK(contains(replay(places).result.errors, "two publishers send scans here: every other scan"));
  CHECK_FALSE(contains(replay(short_drive()).result.errors, "two publishers"));
}

TEST_CASE("scanlockd and scanlock-odometry write the same bytes for a log with faults and a reset") {
  const TemporaryFolder folder;
  std::vector<Event> events = short_drive();
  events[5].data.resize(100);                 // damaged
  events[9] = scan_event(9, 0);               // without a stamp
  events[12] = scan_event(12, utime_of(11));  // a repeated one
  bot_core::pointcloud2_t empty = scan_from({}, utime_of(14), 16, 600);
  empty.width = empty.row_step = empty.data_nbytes = 0;
  empty.data.clear();
  events[14] = {utime_of(14), "LIDAR", bytes_of(empty)};
  scanlock::command_t reset{};
  reset.command = scanlock::command_t::RESET;
  events.insert(events.begin() + 20, {utime_of(20) - 1, "SCANLOCK_COMMAND", bytes_of(reset)});
  write_log(folder / "in.lcmlog", events);
  write_file(folder / "all.toml",
             "[output]\nrigid_transform_channel = \"RIGID\"\nlocal_to_map_channel = "
             "\"TO_MAP\"\nnav_odometry_channel = \"NAV\"\n"
             "pose2d_channel = \"FLAT\"\nstatus_period_s = 0.5\n");
  for (const std::string out : {"a.lcmlog", "b.lcmlog"})
    CHECK(run(folder, {"scanlock-odometry", folder / "in.lcmlog", "-c", folder / "all.toml", "--output",
                       folder / out})
              .code == 0);
  CHECK(run(folder,
            {"scanlockd", "-c", folder / "all.toml", "-l", "file://" + (folder / "in.lcmlog") + "?speed=0",
             "--out-url", "file://" + (folder / "c.lcmlog") + "?mode=w"})
            .code == 0);
  const std::string bytes = read_file(folder / "a.lcmlog");
  CHECK(read_file(folder / "b.lcmlog") == bytes);
  CHECK(read_file(folder / "c.lcmlog") == bytes);
  std::map<std::string, int> counts;
  std::uint32_t epochs = 0;
  for (const Event& event : read_log(folder / "a.lcmlog")) {
    ++counts[event.channel];
    if (event.channel == "SCANLOCK_ODOMETRY") epochs |= 1u << decoded<scanlock::odometry_t>(event).epoch;
  }
  // Without the damaged scan, the scan without a stamp and the repeated one; with a predicted pose for the
  // empty one.
  for (const char* channel : {"POSE_BODY_CORRECTED", "SCANLOCK_LOCAL_POSE", "TO_MAP", "SCANLOCK_ODOMETRY",
                              "RIGID", "NAV", "FLAT"}) {
    CAPTURE(channel);
    CHECK(counts[channel] == kScans - 3);
  }
  CHECK(counts["SCANLOCK_STATUS"] >= 6);
  CHECK(epochs == 3);  // the reset was executed

  // The local pose goes on without a jump where the pose in the map begins anew, and the published transform
  // relates both.
  const auto poses = [&](const char* channel) {
    return scanlock::read_log_poses(folder / "a.lcmlog", channel).trajectory;
  };
  const scanlock::Trajectory in_map = poses("POSE_BODY_CORRECTED"), local = poses("SCANLOCK_LOCAL_POSE"),
                             map_from_local = poses("TO_MAP");
  double jump = 0, local_jump = 0;
  for (std::size_t i = 0; i < local.size(); ++i) {
    CHECK(scanlock::near(map_from_local[i].pose * local[i].pose, in_map[i].pose, 1e-9, 1e-9));
    if (i == 0) continue;
    const auto step = [i](const scanlock::Trajectory& t) {
      return (t[i].pose.translation() - t[i - 1].pose.translation()).norm();
    };
    jump = std::max(jump, step(in_map));
    local_jump = std::max(local_jump, step(local));
  }
  CHECK(jump > 2 * local_jump);
}

TEST_CASE("a replay from a file gives a pose for every scan") {
  const TemporaryFolder folder;
  write_log(folder / "in.lcmlog", drive(16, 16, 900));
  const Result result = run(folder, {"scanlockd", "-l", "file://" + (folder / "in.lcmlog") + "?speed=0",
                                     "--out-url", "file://" + (folder / "out.lcmlog") + "?mode=w"});
  CAPTURE(result.errors);
  CHECK(result.code == 0);
  const auto poses = poses_in(read_log(folder / "out.lcmlog"), "POSE_BODY_CORRECTED");
  CHECK(poses.size() == 16);
  CHECK(worst_error(poses, 16) < 0.05);
}

TEST_CASE("a replay in which no scan was used fails with the reason") {
  std::vector<Event> elsewhere = short_drive(3), far = short_drive(3);
  for (Event& event : elsewhere) event.channel = "VELODYNE";
  const Outcome wrong_channel = replay(elsewhere);
  CHECK(wrong_channel.result.code == 1);
  CHECK(contains(wrong_channel.result.errors, "scans are on VELODYNE (bot_core.pointcloud2_t)"));
  const Outcome none = replay({{1, "POSE", bytes_of(bot_core::planar_lidar_t{})}});
  CHECK(none.result.code == 1);
  const Outcome too_near = replay(far, "[tracker]\nmin_range_m = 500\nmax_range_m = 1000\n");
  CHECK(too_near.result.code == 1);
  CHECK(contains(too_near.result.errors, "from 500 to 1000 m away"));
  const Outcome crossed = replay(far, "[tracker]\nmin_range_m = 50\nmax_range_m = 10\n");
  CHECK(crossed.result.code == 1);
  CHECK(contains(crossed.result.errors, "tracker.min_range_m"));
  for (Event& event : far) {
    bot_core::pointcloud2_t scan = decoded<bot_core::pointcloud2_t>(event);
    for (std::size_t at = 0; at + 4 <= scan.data.size(); at += 4) {
      float value;
      std::memcpy(&value, &scan.data[at], 4);
      value *= 1000;
      std::memcpy(&scan.data[at], &value, 4);
    }
    event.data = bytes_of(scan);
  }
  const Outcome millimetres = replay(far);
  CHECK(millimetres.result.code == 1);
  CHECK(contains(millimetres.result.errors, "are they millimetres?"));
}

TEST_CASE("an output that cannot be written to its end is a failure of the daemon as well") {
  const TemporaryFolder folder;
  write_log(folder / "in.lcmlog", short_drive());
  const Result full = run(folder, {"scanlockd", "-l", "file://" + (folder / "in.lcmlog") + "?speed=0",
                                   "--out-url", "file:///dev/full?mode=w"});
  CHECK(full.code == 1);
  CHECK(contains(full.errors, "/dev/full"));
}
