// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/lcm_log.hpp"

#include <doctest/doctest.h>

#include <random>
#include <stdexcept>

#include "temporary_directory.hpp"

namespace scanlock {
namespace {

struct Outcome {
  std::vector<LogEvent> events;
  std::int64_t damaged = 0, skipped = 0;
  bool truncated = false;
};

Outcome read_all(const std::string& path) {
  LogReader reader(path);
  Outcome outcome;
  while (auto event = reader.next()) outcome.events.push_back(*event);
  outcome.damaged = reader.damaged_places();
  outcome.skipped = reader.skipped_bytes();
  outcome.truncated = reader.truncated();
  CHECK(reader.position() == reader.file_size());
  return outcome;
}

/// Four events of 28 + 5 + 10 * (i + 1) bytes; returns the bytes of the file.
Bytes four_events(const std::string& path) {
  LogWriter writer(path);
  for (int i = 0; i < 4; ++i)
    writer.write(1000 + i, "LIDAR", Bytes(10 * (i + 1), static_cast<std::uint8_t>(i)));
  writer.close();
  return file_bytes(path);
}
constexpr std::size_t kStart[] = {0, 43, 96, 159, 232};  // of each event, and the end

}  // namespace

TEST_CASE("log writer writes the bytes that lcm-logger writes") {
  TemporaryDirectory directory;
  const std::string path = directory / "golden.lcmlog";
  LogWriter writer(path);
  writer.write(0x0102030405060708, "AB", {0xca, 0xfe});
  writer.write(-1, "C", {});
  writer.close();
  const Bytes golden = {0xed, 0xa1, 0xda, 0x01, 0, 0, 0, 0, 0, 0, 0, 0, 1,    2,    3,    4,
                        5,    6,    7,    8,    0, 0, 0, 2, 0, 0, 0, 2, 'A',  'B',  0xca, 0xfe,
                        0xed, 0xa1, 0xda, 0x01, 0, 0, 0, 0, 0, 0, 0, 1, 0xff, 0xff, 0xff, 0xff,
                        0xff, 0xff, 0xff, 0xff, 0, 0, 0, 1, 0, 0, 0, 0, 'C'};
  CHECK(file_bytes(path) == golden);
  const Outcome outcome = read_all(path);
  REQUIRE(outcome.events.size() == 2);
  CHECK(outcome.events[0].utime == 0x0102030405060708);
  CHECK(outcome.events[0].channel == "AB");
  CHECK(outcome.events[0].data == Bytes{0xca, 0xfe});
  CHECK(outcome.events[1].number == 1);
  CHECK(outcome.events[1].utime == -1);
  CHECK(outcome.events[1].data.empty());
  CHECK_FALSE(outcome.truncated);
  CHECK(outcome.damaged == 0);
}

TEST_CASE("a log cut at any length gives its whole events, and the cut is reported") {
  TemporaryDirectory directory;
  const std::string path = directory / "cut.lcmlog";
  const Bytes bytes = four_events(path);
  REQUIRE(bytes.size() == kStart[4]);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    CAPTURE(length);
    write_file(path, Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)));
    const Outcome outcome = read_all(path);
    std::size_t whole = 0;
    while (kStart[whole + 1] <= length) ++whole;
    CHECK(outcome.events.size() == whole);
    CHECK(outcome.truncated == (kStart[whole] != length));
    CHECK(outcome.damaged == 0);
  }
}

TEST_CASE("damage in the middle of a log costs the damaged event only") {
  TemporaryDirectory directory;
  const std::string path = directory / "damaged.lcmlog";
  const Bytes bytes = four_events(path);
  SUBCASE("sync word") {
    Bytes damaged = bytes;
    damaged[kStart[1]] ^= 1;
    write_file(path, damaged);
    const Outcome outcome = read_all(path);
    CHECK(outcome.events.size() == 3);
    CHECK(outcome.damaged == 1);
    CHECK(outcome.skipped == static_cast<std::int64_t>(kStart[2] - kStart[1]));
  }
  SUBCASE("data size too large by a little, by more than the file, by more than LCM allows") {
    for (std::size_t byte : {27, 26, 24}) {
      Bytes damaged = bytes;
      damaged[kStart[1] + byte] = 0x3c;
      write_file(path, damaged);
      const Outcome outcome = read_all(path);
      REQUIRE(outcome.events.size() == 3);
      CHECK(outcome.events[1].number == 2);
      CHECK(outcome.damaged == 1);
      CHECK_FALSE(outcome.truncated);
    }
  }
  SUBCASE("bytes lost and bytes inserted") {
    Bytes lost = bytes;
    lost.erase(lost.begin() + 60, lost.begin() + 70);
    write_file(path, lost);
    CHECK(read_all(path).events.size() == 3);
    Bytes inserted = bytes;
    inserted.insert(inserted.begin() + kStart[2], 300000,
                    0x55);  // more than the reader reads at once
    write_file(path, inserted);
    const Outcome outcome = read_all(path);
    CHECK(outcome.events.size() == 4);
    CHECK(outcome.skipped == 300000);
    CHECK(outcome.damaged == 1);
  }
  SUBCASE("a sync word that straddles two pieces of the search") {
    for (std::size_t garbage = (1u << 18) - 6; garbage < (1u << 18) + 6; ++garbage) {
      Bytes prefixed(garbage, 0);
      prefixed.insert(prefixed.end(), bytes.begin(), bytes.end());
      write_file(path, prefixed);
      CHECK(read_all(path).events.size() == 4);
    }
  }
  SUBCASE("damage, and then a cut end") {
    Bytes damaged(bytes.begin(), bytes.end() - 1);
    damaged[kStart[2] + 1] ^= 1;
    write_file(path, damaged);
    const Outcome outcome = read_all(path);
    CHECK(outcome.events.size() == 2);
    CHECK(outcome.damaged == 1);
    CHECK(outcome.truncated);
  }
}

TEST_CASE("a payload that holds a log is one event") {
  TemporaryDirectory directory;
  const std::string path = directory / "nested.lcmlog";
  const Bytes inner = four_events(path);
  LogWriter writer(path);
  for (int i = 0; i < 3; ++i) writer.write(i, "LOG", inner);
  writer.close();
  const Outcome outcome = read_all(path);
  REQUIRE(outcome.events.size() == 3);
  CHECK(outcome.events[2].data == inner);
  CHECK(outcome.damaged == 0);
}

TEST_CASE("any mutation of a log is read to its end") {
  TemporaryDirectory directory;
  const std::string path = directory / "mutated.lcmlog";
  const Bytes bytes = four_events(path);
  std::mt19937 rng(7);
  for (int trial = 0; trial < 2000; ++trial) {
    Bytes mutated = bytes;
    for (unsigned n = 1 + rng() % 4; n > 0; --n)
      mutated[rng() % mutated.size()] = static_cast<std::uint8_t>(rng());
    write_file(path, mutated);
    const Outcome outcome = read_all(path);
    CHECK(outcome.events.size() <= 4);
  }
}

TEST_CASE("log errors name the file") {
  TemporaryDirectory directory;
  CHECK_THROWS_WITH_AS(LogReader(directory / "none.lcmlog"), doctest::Contains("none.lcmlog"),
                       std::runtime_error);
  CHECK_THROWS_WITH_AS(LogReader(directory / "."), doctest::Contains("regular file"), std::runtime_error);
  CHECK_THROWS_WITH_AS(LogWriter(directory / "no/such.lcmlog"), doctest::Contains("such.lcmlog"),
                       std::runtime_error);
  LogWriter writer(directory / "a.lcmlog");
  CHECK_THROWS_AS(writer.write(0, "", {}), std::runtime_error);
  CHECK_THROWS_AS(writer.write(0, std::string(64, 'x'), {}), std::runtime_error);
}

}  // namespace scanlock
