// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/scan_directory.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <stdexcept>

#include "../contains.hpp"
#include "io/cloud_file.hpp"
#include "temporary_directory.hpp"

namespace scanlock {
namespace {

PointCloud points(int count, float first_x = 0) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    cloud.push_back(first_x + static_cast<float>(i), 1, 2);
    cloud.intensity.push_back(3);
  }
  return cloud;
}

/// The message of the error that opening (and reading the first scan of) the directory throws.
std::string error_of(const std::string& path) {
  try {
    ScanDirectory(path, {}).read(0);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("scans come in the order of their numbers and other files are passed over") {
  TemporaryDirectory directory;
  write_cloud(directory / "scan_10.ply", points(10));
  write_cloud(directory / "000009.bin", points(9));
  write_cloud(directory / "2.PCD", points(2));
  write_file(directory / "poses_3.txt", std::string("no scan"));
  write_file(directory / "map.ply", std::string("no number"));
  const ScanDirectory scans(directory / "", {});
  REQUIRE(scans.size() == 3);
  CHECK(scans.read(0).points.size() == 2);
  CHECK(scans.read(1).points.size() == 9);
  CHECK(scans.read(2).points.size() == 10);
  CHECK_FALSE(scans.read(0).points.has_times());
}

TEST_CASE("stamps without times are a period apart and never zero") {
  TemporaryDirectory directory;
  for (const char* name : {"0.bin", "1.bin", "5.bin"}) write_cloud(directory / name, points(1));
  const ScanDirectory standard(directory / "", {});
  CHECK(standard.utime(0) == 1000000);
  CHECK(standard.utime(2) == 1200000);
  const ScanDirectory moved(directory / "", {0.05, 1600000000000000});
  CHECK(moved.utime(0) == 1600000000000000);
  CHECK(moved.utime(2) == 1600000000100000);
}

TEST_CASE("times are kept to the microsecond") {
  TemporaryDirectory directory;
  for (const char* name : {"0.bin", "1.bin"}) write_cloud(directory / name, points(1));
  const auto stamps = [&](const std::string& times, std::int64_t zero) {
    write_file(directory / "times.txt", times);
    const ScanDirectory scans(directory / "", {0.1, zero});
    return std::vector<std::int64_t>{scans.utime(0), scans.utime(1)};
  };
  CHECK(stamps("0.000000\n0.103736\n", -1) == std::vector<std::int64_t>{1000000, 1103736});
  CHECK(stamps("# s\n1600000000.000001\n1600000000.100003\n", -1) ==
        std::vector<std::int64_t>{1600000000000001, 1600000000100003});
  CHECK(stamps("0\n0.5\n", 0) == std::vector<std::int64_t>{0, 500000});
  CHECK(stamps("2\n3\n", 7) == std::vector<std::int64_t>{2000007, 3000007});
  write_file(directory / "times.txt", std::string("1\n2\n3\n"));
  CHECK(contains(error_of(directory / ""), "times.txt: 3 times for 2 scans"));
  write_file(directory / "times.txt", std::string("1\n1\n"));
  CHECK(contains(error_of(directory / ""), "times.txt:2: the time is not after the one before"));
  write_file(directory / "times.txt", std::string("1\n1e300\n"));
  CHECK(contains(error_of(directory / ""), "times.txt:2: the time is out of range"));
}

TEST_CASE("a directory written is a directory read") {
  TemporaryDirectory directory;
  Scan with_times{1600000000000001, points(5, -0.5f)};
  with_times.points.time = {-0.1f, -0.05f, 0.f, 0.05f, 0.1f};
  const Scan without{1600000000100000, points(3)};
  ScanDirectoryWriter writer(directory / "new/scans");
  writer.write(with_times);
  writer.write(without);
  writer.close();
  const ScanDirectory back(directory / "new/scans", {});
  REQUIRE(back.size() == 2);
  CHECK(back.read(0).utime == with_times.utime);
  CHECK(back.read(0).points.x == with_times.points.x);
  CHECK(back.read(0).points.time == with_times.points.time);
  CHECK(back.read(1).utime == without.utime);
  CHECK_FALSE(back.read(1).points.has_times());
  CHECK_THROWS_WITH_AS(ScanDirectoryWriter(directory / "new/scans"), doctest::Contains("not empty"),
                       std::runtime_error);
}

TEST_CASE("errors of a scan directory name the file") {
  TemporaryDirectory directory;
  CHECK(contains(error_of(directory / "none"), "none: cannot list the directory"));
  CHECK(contains(error_of(directory / ""), "no numbered .bin, .pcd or .ply scans"));
  write_cloud(directory / "1.bin", points(4));
  std::filesystem::create_directory(directory / "ptime");
  write_file(directory / "ptime/1.f32", Bytes(12));
  CHECK(contains(error_of(directory / ""), "1.f32: 12 bytes for 4 points"));
  write_cloud(directory / "01.bin", points(4));
  CHECK(contains(error_of(directory / ""), "01.bin and 1.bin have the same number"));
}

}  // namespace scanlock
