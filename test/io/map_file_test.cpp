// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/map_file.hpp"

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <random>

#include "../contains.hpp"
#include "io/atomic_file.hpp"
#include "io/crc32.hpp"
#include "temporary_directory.hpp"

using namespace scanlock;

namespace {

Pose some_pose(double x) {
  Vector6 xi;
  xi << x, -2, 0.5, 0.1, -0.2, 1.3;
  return se3_exp(xi);
}

SavedMap some_map(int keyframes, int points) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-90, 90);
  SavedMap map;
  map.epoch = 3;
  map.last_pose = some_pose(17);
  for (int k = 0; k < keyframes; ++k) {
    PointCloud cloud;
    for (int i = 0; i < points; ++i) cloud.push_back(uniform(random), uniform(random), uniform(random) / 20);
    if (k > 0) {
      const auto to = static_cast<std::uint32_t>(k + 1);
      map.constraints.push_back({to - 1, to, some_pose(1), (100.0 + k) * Matrix6::Identity(), k % 2 == 0});
      map.constraints.back().information(0, 5) = map.constraints.back().information(5, 0) = 3;
    }
    map.keyframes.push_back({1700000000000000 + k,
                             some_pose(k),
                             12.5f + static_cast<float>(k),
                             cloud,
                             {Eigen::Vector3f(0.6f, 0, 0.8f), Eigen::Vector3f::UnitZ()}});
  }
  return map;
}

std::string error_of(const Bytes& bytes) {
  try {
    decode_map(bytes, "yard.map");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

/// The bytes with a corrected checksum, as of a faulty writer.
Bytes sealed(Bytes bytes) {
  const std::uint32_t sum = crc32(bytes.data(), bytes.size() - 4);
  for (std::size_t i = 0; i < 4; ++i) bytes[bytes.size() - 4 + i] = static_cast<std::uint8_t>(sum >> (8 * i));
  return bytes;
}

std::string error_of_reading(const KeyframePoints& points) {
  try {
    points.cloud();
  } catch (const PointsUnreadable& error) {
    return error.what();
  }
  return "";
}

bool same_points(const SavedMap& a, const SavedMap& b) {
  return std::equal(a.keyframes.begin(), a.keyframes.end(), b.keyframes.begin(), b.keyframes.end(),
                    [](const ArchivedKeyframe& one, const ArchivedKeyframe& other) {
                      const PointCloud p = *one.points.cloud(), q = *other.points.cloud();
                      return one.points.size() == p.size() && p.x == q.x && p.y == q.y && p.z == q.z;
                    });
}

}  // namespace

TEST_CASE("the checksum of parts is that of the whole") {
  Bytes bytes(100);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(37 * i + 11);
  const std::uint32_t whole = crc32(bytes.data(), bytes.size());
  CHECK(whole == 0x7D11B4C9u);
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut)
    CHECK(crc32(&bytes[0] + cut, bytes.size() - cut, crc32(bytes.data(), cut)) == whole);
}

TEST_CASE("points that stay in a file equal the points decoded from memory") {
  const TemporaryDirectory folder;
  const std::string path = folder / "yard.map";
  const SavedMap map = some_map(300, 1500);  // larger than what is read at once
  write_map(path, map);
  const Bytes bytes = file_bytes(path);
  CHECK(bytes == encode_map(map));
  const SavedMap read = read_map(path);
  CHECK(same_points(read, decode_map(bytes, path)));
  CHECK(encode_map(read) == bytes);
}

TEST_CASE("a map that was read outlives the removal of its file, and can be saved to its own file") {
  const TemporaryDirectory folder;
  const std::string path = folder / "yard.map";
  write_map(path, some_map(3, 40));
  const Bytes bytes = file_bytes(path);
  const SavedMap read = read_map(path);
  for (int i = 0; i < 2; ++i) {
    write_map(path, read);
    CHECK(file_bytes(path) == bytes);
  }
  write_map(path, some_map(1, 2));
  CHECK(encode_map(read) == bytes);
  std::filesystem::remove(path);
  CHECK(encode_map(read) == bytes);
}

TEST_CASE("reading points of a file that was changed in place is an error and never gives other points") {
  const TemporaryDirectory folder;
  const std::string path = folder / "yard.map", target = folder / "other.map";
  write_map(path, some_map(3, 40));
  write_map(target, some_map(1, 2));
  const Bytes bytes = file_bytes(path), other = file_bytes(target);
  const SavedMap read = read_map(path);
  const std::string to_do =
      "; points of the loaded map cannot be read: load a map again, and replace map files only with mv";
  Bytes changed = bytes;
  changed[bytes.size() - 4 - 2 * 276 - 4 - 2 * 12 - 4 - 1] ^= 1;  // the last coordinate of the last keyframe
  write_file(path, changed);
  CHECK(error_of_reading(read.keyframes[0].points).empty());
  CHECK(error_of_reading(read.keyframes[2].points) == path + ": was changed in place" + to_do);
  CHECK(read.keyframes[2].points.size() == 40);
  CHECK_THROWS_AS(write_map(target, read), PointsUnreadable);
  CHECK(file_bytes(target) == other);
  CHECK(std::distance(std::filesystem::directory_iterator(folder / ""), {}) == 2);

  write_file(path, Bytes(bytes.begin(), bytes.begin() + 500));
  CHECK(error_of_reading(read.keyframes[1].points) ==
        path + ": cannot read all of its " + std::to_string(bytes.size()) + " bytes" + to_do);

  write_file(path, bytes);
  CHECK(encode_map(read) == bytes);
}

TEST_CASE("an invalid file gives the same error as its bytes in memory") {
  const TemporaryDirectory folder;
  const std::string path = folder / "yard.map";
  const Bytes good = encode_map(some_map(2, 5));
  const auto error_of_file = [&](const Bytes& bytes) -> std::string {
    write_file(path, bytes);
    try {
      read_map(path);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  const auto with_name = [&](std::string error) {
    return error.replace(0, std::string("yard.map").size(), path);
  };
  for (std::size_t i = 0; i < good.size(); i += 7) {
    Bytes bad = good;
    bad[i] ^= 0x40;
    CHECK(error_of_file(bad) == with_name(error_of(bad)));
    CHECK(error_of_file(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(i))) ==
          with_name(error_of(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(i)))));
  }
}

TEST_CASE("the checksum is that of zip") {
  const std::string digits = "123456789";
  CHECK(crc32(reinterpret_cast<const std::uint8_t*>(digits.data()), digits.size()) == 0xCBF43926u);
  CHECK(crc32(nullptr, 0) == 0);
}

TEST_CASE("a map that is read back has exact poses, and points within half a step") {
  const SavedMap map = some_map(5, 200);
  const SavedMap read = decode_map(encode_map(map), "yard.map");
  CHECK(read.epoch == 3);
  CHECK(read.last_pose.matrix() == map.last_pose.matrix());
  REQUIRE(read.keyframes.size() == 5);
  for (std::size_t k = 0; k < 5; ++k) {
    const ArchivedKeyframe &before = map.keyframes[k], &after = read.keyframes[k];
    CHECK(after.utime == before.utime);
    CHECK(after.map_from_body.matrix() == before.map_from_body.matrix());
    CHECK(after.reach == before.reach);
    CHECK(after.body_ups == before.body_ups);
    const PointCloud after_points = *after.points.cloud(), before_points = *before.points.cloud();
    REQUIRE(after_points.size() == 200);
    float worst = 0;
    for (std::size_t i = 0; i < 200; ++i)
      worst = std::max(worst, (after_points.point(i) - before_points.point(i)).cwiseAbs().maxCoeff());
    CHECK(worst <= 0.002f);  // coordinates reach 90 m: steps of 1/256 m
    CHECK(worst > 0);
  }
  REQUIRE(read.constraints.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const Constraint &before = map.constraints[i], &after = read.constraints[i];
    CHECK(after.from == before.from);
    CHECK(after.to == before.to);
    CHECK(after.from_to.matrix() == before.from_to.matrix());
    CHECK(after.information == before.information);
    CHECK(after.loop_closure == before.loop_closure);
  }
}

TEST_CASE("a map that was read is written to the same bytes") {
  const Bytes once = encode_map(some_map(3, 50));
  CHECK(encode_map(decode_map(once, "yard.map")) == once);
}

TEST_CASE("an empty map and an empty keyframe are read back, and points that are not finite are dropped") {
  CHECK(decode_map(encode_map({}), "yard.map").keyframes.empty());
  SavedMap map = some_map(1, 0);
  CHECK(decode_map(encode_map(map), "yard.map").keyframes.at(0).points.empty());
  PointCloud cloud;
  cloud.push_back(1, 2, 3);
  cloud.push_back(std::nanf(""), 2, 3);
  cloud.push_back(1, std::numeric_limits<float>::infinity(), 3);
  map.keyframes[0].points = cloud;
  const SavedMap read = decode_map(encode_map(map), "yard.map");
  REQUIRE(read.keyframes[0].points.size() == 1);
  CHECK((read.keyframes[0].points.cloud()->point(0) - Eigen::Vector3f(1, 2, 3)).norm() < 1e-3f);
}

TEST_CASE("the bytes of all versions stay as they are") {
  SavedMap map;
  map.epoch = 2;
  PointCloud cloud;
  cloud.push_back(1, -2, 0.5f);
  map.keyframes.push_back({5, Pose::Identity(), 8.0f, cloud, {}});
  Bytes expected = {0x89, 'S', 'L', 'M', 'A', 'P', '\r', '\n', 1, 0, 0, 0};
  const auto append = [&](std::initializer_list<int> more) {
    for (const int byte : more) expected.push_back(static_cast<std::uint8_t>(byte));
  };
  const auto append_identity = [&] {
    for (int i = 0; i < 12; ++i)
      i % 5 == 0 ? append({0, 0, 0, 0, 0, 0, 0xF0, 0x3F}) : append({0, 0, 0, 0, 0, 0, 0, 0});
  };
  append({226, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0});
  append_identity();
  append({1, 0, 0, 0, 5, 0, 0, 0, 0, 0, 0, 0});
  append_identity();
  append({0, 0, 0, 0x41});           // 8.0f
  append({0xF3, 0xFF, 0xFF, 0xFF});  // 2^-13 m: 2 m are 16384 steps
  append({1, 0, 0, 0});
  append({0x00, 0x20, 0x00, 0xC0, 0x00, 0x10});
  append({0xFA, 0x9A, 0x97, 0xD7});  // CRC-32, by zlib
  const SavedMap old = decode_map(expected, "yard.map");
  REQUIRE(old.keyframes.size() == 1);
  CHECK(old.keyframes[0].points.cloud()->point(0) == cloud.point(0));
  CHECK(old.keyframes[0].body_ups.empty());

  map.keyframes[0].body_ups.emplace_back(0, 0, 1);
  expected[8] = 2;
  expected[12] = static_cast<std::uint8_t>(226 + 16);
  expected.resize(expected.size() - 4);
  append({1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x80, 0x3F});
  append({0, 0, 0, 0});
  const SavedMap second = decode_map(sealed(expected), "yard.map");
  REQUIRE(second.keyframes.size() == 1);
  CHECK(second.keyframes[0].body_ups == map.keyframes[0].body_ups);
  CHECK(second.constraints.empty());

  Matrix6 information = Matrix6::Identity();
  information(0, 1) = information(1, 0) = 0.5;
  map.constraints.push_back({0, 1, Pose::Identity(), information, true});
  expected[8] = 3;
  const std::size_t body = 226 + 16 + 4 + 276;
  expected[12] = static_cast<std::uint8_t>(body & 255);
  expected[13] = static_cast<std::uint8_t>(body >> 8);
  expected.resize(expected.size() - 4);
  append({1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0});
  append_identity();
  append({1, 0, 0, 0});
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      const bool half = row == 0 && column == 1;
      append({0, 0, 0, 0, 0, 0, half ? 0xE0 : row == column ? 0xF0 : 0, half || row == column ? 0x3F : 0});
    }
  }
  append({0, 0, 0, 0});
  const SavedMap third = decode_map(sealed(expected), "yard.map");
  REQUIRE(third.constraints.size() == 1);
  CHECK(third.constraints[0].information == information);
  CHECK(third.up == Eigen::Vector3d::UnitZ());

  map.up = {0, -1, 0};
  expected[8] = 4;
  expected[12] = static_cast<std::uint8_t>((body + 24) & 255);
  expected[13] = static_cast<std::uint8_t>((body + 24) >> 8);
  Bytes up(24, 0);
  up[14] = 0xF0;
  up[15] = 0xBF;
  expected.insert(expected.begin() + 20 + 4 + 96, up.begin(), up.end());
  CHECK(encode_map(map) == sealed(expected));
  CHECK(decode_map(sealed(expected), "yard.map").up == map.up);
}

TEST_CASE("an invalid map is refused with the byte and the kind of the error") {
  const Bytes good = encode_map(some_map(2, 10));
  CHECK(error_of(good).empty());
  CHECK(error_of(Bytes{}) == "yard.map: byte 0: not a scanlock map");
  CHECK(error_of(Bytes{'p', 'l', 'y', '\n'}) == "yard.map: byte 0: not a scanlock map");
  Bytes newer = good;
  newer[8] = 9;
  CHECK(contains(error_of(newer), "byte 8: version 9"));
  CHECK(contains(error_of(newer), "newer"));
  Bytes cut(good.begin(), good.end() - 7);
  CHECK(contains(error_of(cut), "byte 12: "));
  CHECK(contains(error_of(cut), "cut"));
  Bytes more = good;
  more.push_back(0);
  CHECK(contains(error_of(more), "too long"));
  Bytes flipped = good;
  flipped[200] ^= 1;
  CHECK(contains(error_of(flipped), "byte " + std::to_string(good.size() - 4) + ": the checksum"));
  Bytes counted = good;
  counted[20 + 4 + 96 + 24] = 200;  // more keyframes than the file has, with a correct checksum
  CHECK(contains(error_of(sealed(counted)), "the keyframes would take"));
  const std::size_t end = good.size() - 4 - (4 + 276);  // of the keyframes; then one constraint
  Bytes fallen = good;
  fallen[end - 1] = 0x40;  // the last coordinate of the last body-up direction: 4 instead of 1
  CHECK(contains(error_of(sealed(fallen)), "a body-up attitude is not a unit vector"));
  Bytes crowded = good;
  crowded[end - 24 - 4] = 33;
  CHECK(contains(error_of(sealed(crowded)), "33 body-up attitudes"));
  Bytes unknown = good;
  unknown[end + 4] = 7;
  CHECK(contains(error_of(sealed(unknown)), "a constraint between keyframes 7 and 2 of 2"));
  Bytes looped = good;
  looped[end + 4] = 2;
  CHECK(contains(error_of(sealed(looped)), "a constraint between keyframes 2 and 2 of 2"));
  Bytes kind = good;
  kind[end + 4 + 8 + 96] = 2;
  CHECK(contains(error_of(sealed(kind)), "2 is no kind of constraint"));
  Bytes negative = good;
  negative[good.size() - 4 - 1] ^= 0x80;
  CHECK(contains(error_of(sealed(negative)), "is not positive semidefinite"));
  Bytes bent = good;
  bent[20 + 4 + 7] = 0x7F;  // the first element of the last pose
  CHECK(contains(error_of(sealed(bent)), "byte 24: the last pose is no rigid pose"));
  Bytes fell = good;
  fell[20 + 4 + 96 + 23] = 0x40;  // of the upward direction: 2
  CHECK(contains(error_of(sealed(fell)), "byte 120: the upward direction is not a unit vector"));
}

TEST_CASE("truncated maps and maps with a flipped bit are refused, and none crashes the reader") {
  const Bytes good = encode_map(some_map(3, 20));
  for (std::size_t size = 0; size < good.size(); ++size) {
    const Bytes cut(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
    REQUIRE_FALSE(error_of(cut).empty());
  }
  for (std::size_t byte = 0; byte < good.size(); ++byte) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes flipped = good;
      flipped[byte] = static_cast<std::uint8_t>(flipped[byte] ^ (1 << bit));
      REQUIRE_FALSE(error_of(flipped).empty());
      if (byte < good.size() - 4) error_of(sealed(flipped));  // may be a valid map; must not crash
    }
  }
}

TEST_CASE("random bytes under a fitting checksum do not crash the reader") {
  std::mt19937 random(3);
  for (int round = 0; round < 2000; ++round) {
    Bytes bytes = encode_map(some_map(2, 5));
    for (int k = 0; k < 1 + round % 20; ++k) {
      const std::size_t at = 20 + random() % (bytes.size() - 24);
      bytes[at] = static_cast<std::uint8_t>(random());
    }
    error_of(sealed(bytes));
  }
}

TEST_CASE("a map is written and read as a file, and no other file is left beside it") {
  const TemporaryDirectory folder;
  const SavedMap map = some_map(2, 30);
  write_map(folder / "yard.map", some_map(1, 3));
  write_map(folder / "yard.map", map);
  CHECK(encode_map(read_map(folder / "yard.map")) == encode_map(decode_map(encode_map(map), "")));
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder / "")) ++files;
  CHECK(files == 1);
  struct stat info = {};
  REQUIRE(stat((folder / "yard.map").c_str(), &info) == 0);
  CHECK((info.st_mode & 0400) != 0);
}

TEST_CASE("a file that is no map is not overwritten, a link is followed, a missing folder is named") {
  const TemporaryDirectory folder;
  write_file(folder / "notes.txt", std::string("precious"));
  CHECK_THROWS_WITH(
      write_map(folder / "notes.txt", some_map(1, 1)),
      ((folder / "notes.txt") + ": exists and is not a scanlock map; it is not overwritten").c_str());
  CHECK(file_bytes(folder / "notes.txt").size() == 8);
  write_map(folder / "real.map", some_map(1, 1));
  std::filesystem::create_symlink(folder / "real.map", folder / "link.map");
  write_map(folder / "link.map", some_map(2, 2));
  CHECK(std::filesystem::is_symlink(folder / "link.map"));
  CHECK(read_map(folder / "real.map").keyframes.size() == 2);
  CHECK_THROWS(write_map(folder / "none/yard.map", some_map(1, 1)));
  CHECK_THROWS(write_file_atomically("/dev/null", [](const TakeBytes& take) { take("text"); }));
  CHECK_THROWS(read_map(folder / "missing.map"));
}
