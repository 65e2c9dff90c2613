// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "messages/point_times.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace scanlock;

namespace {

constexpr std::int64_t kStamp = 1700000000500000;  // microseconds

std::vector<float> read(const char* name, TimeKind kind, std::int64_t utime, const std::vector<double>& raw) {
  std::vector<float> seconds;
  const std::string words = interpret_times(name, kind, utime, raw, seconds);
  CAPTURE(words);
  CHECK(words.find(name) != std::string::npos);
  return seconds;
}

void check_near(const std::vector<float>& seconds, double first, double last) {
  REQUIRE(seconds.size() == 2);
  CHECK(std::abs(static_cast<double>(seconds[0]) - first) < 2e-6);
  CHECK(std::abs(static_cast<double>(seconds[1]) - last) < 2e-6);
}

}  // namespace

TEST_CASE("the usual names of a time field") {
  for (const char* name : {"t", "time", "offset_time", "time_offset", "timestamp", "time_stamp", "Timestamp",
                           "t_us", "time_offset_ns", "timestamp_nsec"})
    CHECK(time_name_rank(name).has_value());
  for (const char* name : {"", "x", "ring", "line", "tag", "_ns", "range", "intensity"})
    CHECK_FALSE(time_name_rank(name).has_value());
  CHECK(*time_name_rank("t") < *time_name_rank("timestamp"));
}

TEST_CASE("integers are nanoseconds after the stamp") {
  check_near(read("t", TimeKind::kInteger, kStamp, {0, 99e6}), 0, 0.099);
  check_near(read("offset_time", TimeKind::kInteger, kStamp, {-50e6, 50e6}), -0.05, 0.05);
}

TEST_CASE("a unit in the name decides") {
  check_near(read("t_us", TimeKind::kInteger, kStamp, {0, 99e3}), 0, 0.099);
  check_near(read("time_ms", TimeKind::kFloat32, kStamp, {0, 99}), 0, 0.099);
  check_near(read("timestamp_ns", TimeKind::kFloat64, kStamp, {1.7000000004e18, 1.7000000005e18}), -0.1, 0);
}

TEST_CASE("floats are seconds after the stamp") {
  check_near(read("time", TimeKind::kFloat32, kStamp, {-0.1, 0}), -0.1, 0);
  check_near(read("time", TimeKind::kFloat64, kStamp, {0, 0.1}), 0, 0.1);
}

TEST_CASE("doubles since the epoch are read in seconds, milliseconds, microseconds or nanoseconds") {
  check_near(read("timestamp", TimeKind::kFloat64, kStamp, {1700000000.5, 1700000000.6}), 0, 0.1);
  check_near(read("timestamp", TimeKind::kFloat64, kStamp, {1700000000500e0, 1700000000600e0}), 0, 0.1);
  check_near(read("timestamp", TimeKind::kFloat64, kStamp, {1700000000400000e0, 1700000000500000e0}), -0.1,
             0);
  check_near(read("timestamp", TimeKind::kFloat64, kStamp, {1.7000000005e18, 1.7000000006e18}), 0, 0.1);
}

TEST_CASE("times of a clock that began at zero are distinguished from times after the stamp") {
  check_near(read("timestamp", TimeKind::kFloat64, 5000000, {5.0, 5.1}), 0, 0.1);
  check_near(read("timestamp", TimeKind::kFloat64, 5000000, {0.0, 0.1}), 0, 0.1);
}

TEST_CASE("without a stamp, epoch times count from the earliest point") {
  check_near(read("timestamp", TimeKind::kFloat64, 0, {1700000000.6, 1700000000.5}), 0.1, 0);
}

TEST_CASE("times that make no sense are left out") {
  CHECK(read("time", TimeKind::kFloat32, kStamp, {0, 90000}).empty());  // microseconds in a float?
  CHECK(read("timestamp", TimeKind::kFloat64, kStamp, {12345.0, 12345.1}).empty());  // another clock
  CHECK(read("timestamp", TimeKind::kFloat64, kStamp, {1600000000.0, 1600000000.1}).empty());
  CHECK(read("t", TimeKind::kFloat32, kStamp, {0, std::nan("")}).empty());
  CHECK(read("times", TimeKind::kMicrosecondsOfEpoch, kStamp, {0, 0}).empty());
}
