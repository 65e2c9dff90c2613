// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/cloud_file.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <random>
#include <stdexcept>

#include "../contains.hpp"
#include "cloud_samples.hpp"

namespace scanlock {
namespace {

/// (1 2 3) and (-4 5.5 600), the points of all samples.
void check_two_points(const PointCloud& cloud) {
  REQUIRE(cloud.size() == 2);
  CHECK(cloud.point(0) == Eigen::Vector3f(1, 2, 3));
  CHECK(cloud.point(1) == Eigen::Vector3f(-4, 5.5, 600));
}

PointCloud full_cloud() {
  std::mt19937 rng(3);
  std::normal_distribution<float> normal(0, 50);
  PointCloud cloud;
  for (int i = 0; i < 500; ++i) {
    cloud.push_back(normal(rng), normal(rng), normal(rng));
    cloud.nx.push_back(0.6f);
    cloud.ny.push_back(0.f);
    cloud.nz.push_back(-0.8f);
    cloud.intensity.push_back(normal(rng));
    cloud.time.push_back(-0.1f + 0.0002f * static_cast<float>(i));
  }
  cloud.x[7] = std::numeric_limits<float>::quiet_NaN();
  cloud.y[8] = -std::numeric_limits<float>::infinity();
  return cloud;
}

bool same(const std::vector<float>& a, const std::vector<float>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](float p, float q) { return p == q || (std::isnan(p) && std::isnan(q)); });
}

std::string message_of(const std::string& path) {
  try {
    read_cloud(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("clouds survive a round trip bit for bit with NaN included") {
  TemporaryDirectory directory;
  const PointCloud cloud = full_cloud();
  for (const char* extension : {".bin", ".ply", ".pcd", ".xyz", ".TXT"}) {
    CAPTURE(extension);
    const std::string path = directory / (std::string("cloud") + extension);
    write_cloud(path, cloud);
    const PointCloud back = read_cloud(path);
    CHECK(same(back.x, cloud.x));
    CHECK(same(back.y, cloud.y));
    CHECK(same(back.z, cloud.z));
    CHECK(same(back.intensity, cloud.intensity));
    const bool rich = std::string(extension) == ".ply" || std::string(extension) == ".pcd";
    CHECK(same(back.nx, rich ? cloud.nx : std::vector<float>()));
    CHECK(same(back.nz, rich ? cloud.nz : std::vector<float>()));
    CHECK(same(back.time, rich ? cloud.time : std::vector<float>()));
  }
}

TEST_CASE("an empty cloud is a file and comes back empty") {
  TemporaryDirectory directory;
  for (const char* name : {"e.bin", "e.ply", "e.pcd", "e.xyz"}) {
    write_cloud(directory / name, {});
    CHECK(read_cloud(directory / name).empty());
  }
}

TEST_CASE("binary PLY of either endianness with lists and any scalar types") {
  TemporaryDirectory directory;
  for (const bool big_endian : {false, true}) {
    write_file(directory / "a.ply", odd_binary_ply(big_endian));
    const PointCloud cloud = read_cloud(directory / "a.ply");
    check_two_points(cloud);
    CHECK(cloud.intensity == std::vector<float>{65535, 7});
    CHECK(cloud.normal(0) == Eigen::Vector3f(0, 0, 1));
    CHECK(cloud.normal(1) == Eigen::Vector3f(0.6f, 0.8f, 0));
    CHECK_FALSE(cloud.has_times());
  }
}

TEST_CASE("ascii PLY") {
  TemporaryDirectory directory;
  write_file(directory / "a.ply", ascii_ply());
  check_two_points(read_cloud(directory / "a.ply"));
}

TEST_CASE("PCD in its three encodings with padding and any field order") {
  TemporaryDirectory directory;
  write_file(directory / "ascii.pcd", ascii_pcd());
  write_file(directory / "binary.pcd", binary_pcd());
  write_file(directory / "compressed.pcd", compressed_pcd());
  for (const char* name : {"ascii.pcd", "binary.pcd", "compressed.pcd"}) {
    CAPTURE(name);
    const PointCloud cloud = read_cloud(directory / name);
    check_two_points(cloud);
    CHECK(cloud.intensity == std::vector<float>{65535, 7});
  }
}

TEST_CASE("xyz with comments and without intensity") {
  TemporaryDirectory directory;
  write_file(directory / "a.xyz", std::string("# x y z\n1 2 3\n\n-4\t5.5 6e2 # last"));
  const PointCloud cloud = read_cloud(directory / "a.xyz");
  check_two_points(cloud);
  CHECK_FALSE(cloud.has_intensity());
}

TEST_CASE("errors of a cloud file name the file, the line or byte, and the fault") {
  TemporaryDirectory directory;
  const auto message = [&](const std::string& name, const auto& content) {
    write_file(directory / name, content);
    return message_of(directory / name);
  };
  CHECK(contains(message("a.bin", Bytes(33)), "a.bin: byte 32: the file ends within a point"));
  CHECK(contains(message_of(directory / "none.ply"), "none.ply: no such file"));
  CHECK(contains(message("a.las", Bytes(3)), "unknown kind of cloud"));
  CHECK(contains(message("a.xyz", std::string("1 2 3\n1 2\n")), "a.xyz:2: 2 numbers where"));
  CHECK(contains(message("a.ply", std::string("plx\n")), "a.ply:1: not a PLY file"));
  CHECK(contains(message("a.ply", std::string("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                                              "property float z\nend_header\n1 2\n")),
                 "a.ply:6: the element vertex has no property 'y'"));
  CHECK(contains(message("a.ply", ascii_ply() + "garbage"), "no error"));  // after the vertices
  std::string ply = ascii_ply();
  ply.replace(ply.find("5.5"), 3, "5,5");
  CHECK(contains(message("a.ply", ply), "a.ply:13: the line has 4 numbers"));
  CHECK(contains(message("a.pcd", std::string("FIELDS x y\nSIZE 4 4\nTYPE F F\nWIDTH 1\nDATA ascii\n1 2\n")),
                 "a.pcd:5: the file has no field 'z'"));
  CHECK(contains(message("a.pcd", std::string("FIELDS x y z\nSIZE 4 4\n")), "a.pcd:2: SIZE has 2 entries"));
  Bytes compressed = compressed_pcd();
  compressed.resize(compressed.size() - 1);
  CHECK(contains(message("a.pcd", compressed), "the file is cut short"));
}

TEST_CASE("a header that announces more than the file holds is refused before anything is allocated") {
  TemporaryDirectory directory;
  for (const char* count : {"18446744073709551615", "9000000000000000000", "4000000000"}) {
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      write_file(directory / "a.ply",
                 std::string("ply\nformat ") + format + " 1.0\nelement vertex " + count +
                     "\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n");
      CHECK(contains(message_of(directory / "a.ply"), "the file is cut short"));
    }
    for (const char* format : {"ascii", "binary", "binary_compressed"}) {
      write_file(directory / "a.pcd", std::string("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nPOINTS ") +
                                          count + "\nDATA " + format +
                                          "\n\x01\0\0\0\xff\xff\xff\xff 1 2 3\n");
      CHECK(message_of(directory / "a.pcd") != "no error");
    }
  }
}

TEST_CASE("a file of many points is read in parts, in its order") {
  TemporaryDirectory directory;
  PointCloud cloud;
  for (std::size_t i = 0; i < 2 * kPartPoints + 5; ++i) {
    const auto v = static_cast<float>(i);  // exact in float
    cloud.push_back(v, v + 1, v + 2);
    cloud.intensity.push_back(v + 3);
  }
  for (const char* name : {"a.bin", "a.ply", "a.pcd", "a.xyz"}) {
    CAPTURE(name);
    write_cloud(directory / name, cloud);
    std::vector<std::size_t> sizes;
    std::size_t at = 0, wrong = 0;
    std::uint64_t done = 0, total = 0;
    read_cloud(
        directory / name,
        [&](PointCloud&& part) {
          sizes.push_back(part.size());
          REQUIRE(part.has_intensity());
          for (std::size_t i = 0; i < part.size(); ++i, ++at) {
            const bool same = part.point(i) == cloud.point(at) && part.intensity[i] == cloud.intensity[at];
            wrong += same ? 0 : 1;
          }
        },
        [&](std::uint64_t bytes, std::uint64_t all) {
          CHECK(bytes > done);
          done = bytes;
          total = all;
        });
    CHECK(sizes == std::vector<std::size_t>{kPartPoints, kPartPoints, 5});
    CHECK(wrong == 0);
    CHECK(done == total);
    CHECK(total == std::filesystem::file_size(directory / name));
    CHECK(same(read_cloud(directory / name).z, cloud.z));
  }
}

TEST_CASE("a text file with a line of more than 1 MiB is refused") {
  TemporaryDirectory directory;
  for (const char* name : {"a.ply", "a.pcd", "a.xyz"}) {
    write_file(directory / name, std::string(std::size_t{3} << 20, '7'));
    CHECK(
        contains(message_of(directory / name), std::string(name) + ":1: a line of more than 1048576 bytes"));
  }
}

TEST_CASE("truncated and mutated clouds throw or give a cloud no larger than the file justifies") {
  TemporaryDirectory directory;
  const std::string ascii[] = {ascii_ply(), ascii_pcd(), "1 2 3 4\n5 6 7 8\n"};
  const std::pair<const char*, Bytes> samples[] = {
      {"f.ply", Bytes(ascii[0].begin(), ascii[0].end())},
      {"f.ply", odd_binary_ply(false)},
      {"f.ply", odd_binary_ply(true)},
      {"f.pcd", Bytes(ascii[1].begin(), ascii[1].end())},
      {"f.pcd", binary_pcd()},
      {"f.pcd", compressed_pcd()},
      {"f.bin", Bytes(64, 1)},
      {"f.xyz", Bytes(ascii[2].begin(), ascii[2].end())},
  };
  std::mt19937 rng(11);
  for (const auto& [name, bytes] : samples) {
    const std::string path = directory / name;
    const auto try_to_read = [&](const Bytes& damaged) {
      write_file(path, damaged);
      std::size_t points = 0;
      std::string error = path + ":";
      try {
        points = read_cloud(path).size();
      } catch (const std::runtime_error& thrown) {
        error = thrown.what();
      }
      CHECK(points <= 100 * damaged.size());
      CHECK(contains(error, path + ":"));
    };
    for (std::size_t length = 0; length < bytes.size(); ++length)
      try_to_read(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)));
    for (int trial = 0; trial < 1000; ++trial) {
      Bytes mutated = bytes;
      for (auto n = 1 + rng() % 3; n > 0; --n) {
        const bool digit = rng() % 2 == 0;
        mutated[rng() % mutated.size()] = static_cast<std::uint8_t>(digit ? '0' + rng() % 10 : rng());
      }
      try_to_read(mutated);
    }
  }
}

}  // namespace scanlock
