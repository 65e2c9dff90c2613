// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <bot_core/ins_t.hpp>
#include <bot_core/pose_t.hpp>
#include <cmath>
#include <sstream>

#include "process.hpp"
#include "synthetic.hpp"

using namespace scanlock::test;

namespace {

constexpr int kDrivenScans = 12;
constexpr const char* kConfig = "[input]\nprior_odometry_channel = \"WHEELS\"\nattitude_channel = \"IMU\"\n";

/// The drive with wheel odometry and an inertial sensor at 50 Hz, whose stamps are `shift` microseconds off.
std::vector<Event> drive_with_priors(std::int64_t shift) {
  std::vector<Event> events;
  for (int i = 0; i < kDrivenScans; ++i) {
    for (int k = 0; k < 5; ++k) {
      const std::int64_t utime = utime_of(i) - 80000 + 20000 * k;
      bot_core::pose_t wheels{};
      wheels.utime = utime + shift;
      wheels.pos[0] = 8e-6 * static_cast<double>(utime - utime_of(0));
      wheels.orientation[0] = 1;
      events.push_back({utime, "WHEELS", bytes_of(wheels)});
      bot_core::ins_t level{};
      level.utime = utime + shift;
      level.quat[0] = 1;
      events.push_back({utime, "IMU", bytes_of(level)});
    }
    events.push_back({utime_of(i), "LIDAR", bytes_of(scan_from(place_on_drive(i), utime_of(i), 16, 900))});
  }
  return events;
}

Result replay(const TemporaryFolder& folder, const std::string& log, const std::string& output) {
  write_file(folder / "priors.toml", kConfig);
  return run(folder, {"scanlock-odometry", folder / log, "-c", folder / "priors.toml", "--output",
                      folder / output, "--json"});
}

}  // namespace

namespace {

/// The warnings of a replay, except the one about scans without times of points, as these are.
std::string complaints(const Result& result) {
  std::string left;
  std::istringstream lines(result.errors);
  for (std::string line; std::getline(lines, line);)
    if (line.find("scans without times of points") == std::string::npos) left += line + "\n";
  return left;
}

/// The poses of a log, byte by byte.
std::string odometry_in(const std::string& log) {
  std::string bytes;
  for (const Event& event : read_log(log))
    if (event.channel == "SCANLOCK_ODOMETRY") bytes.append(event.data.begin(), event.data.end());
  return bytes;
}

}  // namespace

TEST_CASE("a replay with priors gives the same bytes twice and reports no fault") {
  const TemporaryFolder folder;
  write_log(folder / "drive.lcmlog", drive_with_priors(0));
  const Result first = replay(folder, "drive.lcmlog", "first.lcmlog");
  const Result second = replay(folder, "drive.lcmlog", "second.lcmlog");
  CHECK(first.code == 0);
  CHECK(complaints(first) == "");
  CHECK(read_file(folder / "first.lcmlog") == read_file(folder / "second.lcmlog"));
  CHECK(worst_error(poses_in(read_log(folder / "first.lcmlog"), "POSE_BODY_CORRECTED"), kDrivenScans) < 0.3);
}

TEST_CASE("priors on another clock are reported and the poses are as without them") {
  const TemporaryFolder folder;
  write_log(folder / "shifted.lcmlog", drive_with_priors(3600000000));
  const Result shifted = replay(folder, "shifted.lcmlog", "shifted_out.lcmlog");
  CHECK(shifted.code == 0);
  CHECK(shifted.errors.find("3600.00 s ahead") != std::string::npos);
  const Result plain = run(folder, {"scanlock-odometry", folder / "shifted.lcmlog", "--output",
                                    folder / "plain_out.lcmlog", "--json"});
  CHECK(plain.code == 0);
  CHECK(complaints(plain) == "");
  CHECK_FALSE(odometry_in(folder / "plain_out.lcmlog").empty());
  CHECK(odometry_in(folder / "shifted_out.lcmlog") == odometry_in(folder / "plain_out.lcmlog"));
}

TEST_CASE("a channel with two purposes is an error that names both") {
  const TemporaryFolder folder;
  write_file(folder / "loop.toml", "[input]\nprior_odometry_channel = \"POSE_BODY_CORRECTED\"\n");
  const Result result = run(folder, {"scanlockd", "-c", folder / "loop.toml"});
  CHECK(result.code == 1);
  CHECK(result.errors.find("output.pose_channel") != std::string::npos);
}
