// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/scan_log.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "io/cloud_file.hpp"
#include "io/lcm_log.hpp"
#include "io/log_info.hpp"
#include "recordings.hpp"
#include "temporary_directory.hpp"

namespace scanlock {
namespace {

void no_progress(std::uint64_t, std::uint64_t) {}

/// Scans of a ring of 20000 points with times, large enough to need several sectors.
void write_scans(const std::string& path, int count) {
  ScanDirectoryWriter writer(path);
  for (int n = 0; n < count; ++n) {
    Scan scan;
    scan.utime = 5000000 + 100000 * n;
    for (int i = 0; i < 20000; ++i) {
      const float angle = -3.1f + 6.2f * static_cast<float>(i) / 20000;
      scan.points.push_back(10 * std::cos(angle), 10 * std::sin(angle), static_cast<float>(n));
      scan.points.intensity.push_back(static_cast<float>(i % 100));
      scan.points.time.push_back(0.1f * static_cast<float>(i) / 20000 - 0.1f);
    }
    writer.write(scan);
  }
  writer.close();
}

void truncate_by(const std::string& path, std::uintmax_t bytes) {
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - bytes);
}

}  // namespace

TEST_CASE("scans survive a round trip through a log in every three-dimensional type") {
  TemporaryDirectory directory;
  write_scans(directory / "in", 3);
  const ScanDirectory in(directory / "in", {});
  const std::string log = directory / "a.lcmlog";
  for (const ScanMessage type :
       {ScanMessage::kPointcloud2, ScanMessage::kPointcloud, ScanMessage::kDrake, ScanMessage::kSectors}) {
    CAPTURE(static_cast<int>(type));
    CHECK(directory_to_log(in, log, "SCANS", type, no_progress).scans == 3);
    std::filesystem::remove_all(directory / "out");
    const ScanConversion result = log_to_directory(log, "SCANS", directory / "out", no_progress);
    CHECK(result.scans == 3);
    CHECK(result.points == 60000);
    CHECK(result.incomplete == 0);
    CHECK(result.damage == "");
    const ScanDirectory out(directory / "out", {});
    REQUIRE(out.size() == 3);
    const double tolerance = type == ScanMessage::kSectors ? 1e-3 : 0;  // sectors round to 16 bits
    for (std::size_t n = 0; n < 3; ++n) {
      const Scan a = in.read(n), b = out.read(n);
      CHECK(a.utime == b.utime);
      double position_off = 0, time_off = 0;
      for (std::size_t i = 0; i < a.points.size(); ++i) {
        position_off = std::max<double>(position_off, (a.points.point(i) - b.points.point(i)).norm());
        time_off = std::max<double>(time_off, std::abs(a.points.time[i] - b.points.time[i]));
      }
      CHECK(position_off <= tolerance);
      CHECK(time_off <= tolerance);
    }
  }
}

TEST_CASE("events carry the utime of their scan so that a player keeps the rate") {
  TemporaryDirectory directory;
  write_scans(directory / "in", 2);
  for (const ScanMessage type : {ScanMessage::kPointcloud2, ScanMessage::kSectors, ScanMessage::kPlanar}) {
    directory_to_log(ScanDirectory(directory / "in", {}), directory / "a.lcmlog", "LIDAR", type, no_progress);
    LogReader reader(directory / "a.lcmlog");
    std::int64_t last = 5000000;
    std::size_t largest = 0;
    while (const auto event = reader.next()) {
      CHECK((event->utime == last || event->utime == last + 100000));
      last = event->utime;
      largest = std::max(largest, event->data.size());
    }
    CHECK(last == 5100000);
    if (type == ScanMessage::kSectors) CHECK(largest <= 60000);
  }
}

TEST_CASE("a damaged log gives its whole scans and reports the damage") {
  TemporaryDirectory directory;
  write_scans(directory / "in", 3);
  const ScanDirectory in(directory / "in", {});
  directory_to_log(in, directory / "a.lcmlog", "LIDAR", ScanMessage::kPointcloud2, no_progress);
  truncate_by(directory / "a.lcmlog", 1);
  const ScanConversion result =
      log_to_directory(directory / "a.lcmlog", "LIDAR", directory / "out", no_progress);
  CHECK(result.scans == 2);
  CHECK(result.damage == "its last event is cut short");

  directory_to_log(in, directory / "s.lcmlog", "LIDAR", ScanMessage::kSectors, no_progress);
  truncate_by(directory / "s.lcmlog", 1);
  const ScanConversion sectors =
      log_to_directory(directory / "s.lcmlog", "LIDAR", directory / "out2", no_progress);
  CHECK(sectors.scans == 3);
  CHECK(sectors.incomplete == 1);
  CHECK(sectors.points < 60000);
}

TEST_CASE("a channel without scans is an error that names the channels of the log") {
  TemporaryDirectory directory;
  LogWriter writer(directory / "a.lcmlog");
  writer.write(1, "NOISE", {1, 2, 3, 4, 5, 6, 7, 8});
  writer.close();
  CHECK_THROWS_WITH_AS(log_to_directory(directory / "a.lcmlog", "LIDAR", directory / "out", no_progress),
                       doctest::Contains("nothing on channel LIDAR; the log has NOISE"), std::runtime_error);
  CHECK_THROWS_WITH_AS(log_to_directory(directory / "a.lcmlog", "NOISE", directory / "out", no_progress),
                       doctest::Contains("channel NOISE holds no scan"), std::runtime_error);
  CHECK_FALSE(std::filesystem::exists(directory / "out"));
}

TEST_CASE("scans of a log are exported to pcd and ply with the times of their points") {
  TemporaryDirectory directory;
  write_scans(directory / "in", 2);
  const ScanDirectory in(directory / "in", {});
  directory_to_log(in, directory / "a.lcmlog", "LIDAR", ScanMessage::kPointcloud2, no_progress);
  for (const std::string extension : {".pcd", ".ply"}) {
    CAPTURE(extension);
    const std::string out = directory / ("out" + extension);  // a folder may have any name
    CHECK(log_to_directory(directory / "a.lcmlog", "LIDAR", out, no_progress, false, extension).scans == 2);
    CHECK(std::filesystem::exists(out + "/000001" + extension));
    CHECK_FALSE(std::filesystem::exists(out + "/ptime"));
    const ScanDirectory back(out, {});
    REQUIRE(back.size() == 2);
    CHECK(back.read(1).utime == in.read(1).utime);
    CHECK(back.read(1).points.x == in.read(1).points.x);
    CHECK(back.read(1).points.intensity == in.read(1).points.intensity);
    CHECK(back.read(1).points.time == in.read(1).points.time);
    CHECK_THROWS_WITH_AS(log_to_directory(directory / "a.lcmlog", "LIDAR", out, no_progress, true),
                         doctest::Contains("holds scans of other names"), std::runtime_error);
    CHECK(log_to_directory(directory / "a.lcmlog", "LIDAR", out, no_progress, true, extension).scans == 2);
  }
}

TEST_CASE("one scan of a log is exported as a cloud, chosen by its number if there are more") {
  TemporaryDirectory directory;
  const std::string log = directory / "a.lcmlog", cloud = directory / "a.pcd";
  write_scans(directory / "in", 3);
  const ScanDirectory in(directory / "in", {});
  directory_to_log(in, log, "LIDAR", ScanMessage::kSectors, no_progress);
  CHECK_THROWS_WITH_AS(log_to_cloud(log, "LIDAR", cloud, {}, no_progress),
                       doctest::Contains("holds more than one scan: --scan N"), std::runtime_error);
  CHECK_THROWS_WITH_AS(log_to_cloud(log, "LIDAR", cloud, 3, no_progress),
                       doctest::Contains("holds 3 scans, the last is number 2"), std::runtime_error);
  CHECK_THROWS_WITH_AS(log_to_cloud(log, "TOP", cloud, 0, no_progress),
                       doctest::Contains("nothing on channel TOP; the log has LIDAR"), std::runtime_error);
  CHECK_FALSE(std::filesystem::exists(cloud));
  for (const int number : {0, 2}) {
    const ScanConversion result =
        log_to_cloud(log, "LIDAR", cloud, static_cast<std::size_t>(number), no_progress);
    CHECK(result.scans == 1);
    CHECK(result.points == 20000);
    CHECK(read_cloud(cloud).z[0] == doctest::Approx(number).epsilon(1e-3));  // the z of a scan is its number
  }
  write_scans(directory / "one", 1);
  directory_to_log(ScanDirectory(directory / "one", {}), log, "LIDAR", ScanMessage::kPointcloud, no_progress);
  CHECK(log_to_cloud(log, "LIDAR", directory / "b.ply", {}, no_progress).points == 20000);
}

TEST_CASE("log info lists channels, types, rates and gaps") {
  TemporaryDirectory directory;
  write_scans(directory / "in", 3);
  directory_to_log(ScanDirectory(directory / "in", {}), directory / "s.lcmlog", "LIDAR",
                   ScanMessage::kSectors, no_progress);
  LogWriter writer(directory / "b.lcmlog");
  LogReader scans(directory / "s.lcmlog");
  while (const auto event = scans.next()) writer.write(event->utime, event->channel, event->data);
  for (int i = 0; i < 20; ++i)
    if (i != 7 && i != 8) writer.write(5000000 + 10000 * i, "ODD", {0xab, 0, 0, 0, 0, 0, 0, 1, 9});
  writer.write(4000000, "ODD", {1});
  writer.close();
  const LogInfo info = inspect_log(directory / "b.lcmlog", no_progress);
  REQUIRE(info.channels.size() == 2);
  const ChannelInfo& lidar = info.channels[0];
  CHECK(lidar.name == "LIDAR");
  CHECK(lidar.type == "scanlock.scan_sector_t");
  CHECK(lidar.events > 6);
  CHECK(lidar.rate_hz == doctest::Approx(10));
  CHECK(lidar.gaps == 0);
  const ChannelInfo& odd = info.channels[1];
  CHECK(odd.type == "unknown 0000000000000000, unknown ab00000000000001");
  CHECK(odd.events == 19);
  CHECK(odd.bytes == 18 * 9 + 1);
  CHECK(odd.rate_hz == doctest::Approx(100));
  CHECK(odd.gaps == 1);
  CHECK(odd.largest_gap_s == doctest::Approx(0.03));
  CHECK(odd.backward_steps == 1);
  CHECK(info.duration_s == doctest::Approx(1.2));
  CHECK_FALSE(info.truncated);
}

TEST_CASE("stamps at the ends of their range do not overflow") {
  TemporaryDirectory directory;
  LogWriter writer(directory / "a.lcmlog");
  writer.write(std::numeric_limits<std::int64_t>::min(), "A", {});
  writer.write(std::numeric_limits<std::int64_t>::max(), "A", {});
  writer.close();
  CHECK(inspect_log(directory / "a.lcmlog", no_progress).duration_s == doctest::Approx(1.8446744e13));
}

TEST_CASE("the real recording survives a round trip through a log") {
  const std::filesystem::path data = recordings();
  if (!std::filesystem::exists(data / "seq/kitti_00_16")) {
    MESSAGE("skipped: no recordings in $SCANLOCK_DATA or ../shared/data");
    return;
  }
  TemporaryDirectory directory;
  const ScanDirectory in((data / "seq/kitti_00_16").string(), {});
  REQUIRE(in.size() == 16);
  CHECK(in.utime(1) == 1103736);
  directory_to_log(in, directory / "k.lcmlog", "LIDAR", ScanMessage::kPointcloud2, no_progress);
  log_to_directory(directory / "k.lcmlog", "LIDAR", directory / "out", no_progress);
  CHECK(file_bytes(directory / "out/000015.bin") ==
        file_bytes((data / "seq/kitti_00_16/000015.bin").string()));
}

}  // namespace scanlock
