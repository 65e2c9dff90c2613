// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/prior_buffer.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace scanlock;

namespace {

constexpr std::int64_t kFirstSample = 1700000000000000;

/// A robot on a circle: 2 m/s, 0.5 rad/s.
Pose on_circle(std::int64_t utime) {
  Vector6 twist;
  twist << 2, 0, 0, 0, 0, 0.5;
  return se3_exp(1e-6 * static_cast<double>(utime - kFirstSample) * twist);
}

PriorBuffer filled(std::int64_t period, int samples) {
  PriorBuffer buffer;
  for (int i = 0; i < samples; ++i) {
    const std::int64_t utime = kFirstSample + i * period;
    CHECK(buffer.add(utime, on_circle(utime)) == PriorBuffer::Addition::kTaken);
  }
  return buffer;
}

using Absence = PriorBuffer::Absence;

}  // namespace

TEST_CASE("the motion is interpolated between samples and extrapolated shortly after the last sample") {
  PriorBuffer buffer = filled(20000, 50);
  for (const std::int64_t offset : {0, 7000, 20000, 333333, 980000, 1000000, 1079000}) {
    CAPTURE(offset);
    const auto answer = buffer.at(kFirstSample + offset);
    REQUIRE(answer.pose);
    CHECK(answer.pose->isApprox(on_circle(kFirstSample + offset), 1e-9));
  }
}

TEST_CASE("without a sample near the scan the prior is stale, and no pose is invented") {
  PriorBuffer buffer;
  CHECK(buffer.at(kFirstSample).absence == Absence::kNever);
  buffer = filled(20000, 50);  // to 0.98 s
  const auto late = buffer.at(kFirstSample + 1500000);
  CHECK_FALSE(late.pose);
  CHECK(late.absence == Absence::kStale);
  CHECK(late.offset_s == doctest::Approx(-0.52));
  CHECK(buffer.at(kFirstSample - 10000).absence == Absence::kStale);
  PriorBuffer slow = filled(800000, 3);
  CHECK(slow.at(kFirstSample + 1200000).absence == Absence::kStale);
  CHECK(slow.at(kFirstSample + 800000).pose);  // exactly at a sample
}

TEST_CASE("a sensor on another clock is distinguished from a silent one") {
  for (const std::int64_t shift : {3600000000, -3600000000, -3000000L, 3000000L}) {
    CAPTURE(shift);
    PriorBuffer buffer;
    for (int i = 0; i < 100; ++i) {  // two samples per scan
      const std::int64_t utime = kFirstSample + 50000 * i;
      buffer.add(utime + shift, on_circle(utime));
      if (i % 2 == 0) continue;
      const auto answer = buffer.at(utime);
      CHECK_FALSE(answer.pose);
      CHECK(answer.absence == Absence::kShifted);
      CHECK(answer.offset_s == doctest::Approx(1e-6 * static_cast<double>(shift)));
    }
  }
  PriorBuffer silent;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t utime = kFirstSample + 100000 * i;
    if (i < 50) silent.add(utime, on_circle(utime));
    const auto answer = silent.at(utime);
    CHECK(answer.absence == (i < 51 ? Absence::kNone : Absence::kStale));
  }
  CHECK(offset_words(12) == "12.00 s ahead");
  CHECK(offset_words(-3599.02) == "3599.02 s behind");
}

TEST_CASE("backward, repeated and non-finite samples are ignored, and a new run starts again") {
  PriorBuffer buffer = filled(20000, 50);
  const std::int64_t last = kFirstSample + 49 * 20000;
  Pose elsewhere = Pose::Identity();
  elsewhere.translation().setConstant(1000);
  CHECK(buffer.add(last, elsewhere) == PriorBuffer::Addition::kBackward);
  CHECK(buffer.add(last - 500000, elsewhere) == PriorBuffer::Addition::kBackward);
  elsewhere.translation().x() = std::numeric_limits<double>::quiet_NaN();
  CHECK(buffer.add(last + 20000, elsewhere) == PriorBuffer::Addition::kNotFinite);
  CHECK(buffer.at(last).pose->isApprox(on_circle(last), 1e-9));
  CHECK(buffer.add(kFirstSample - 10000000, Pose::Identity()) == PriorBuffer::Addition::kRestarted);
  CHECK_FALSE(buffer.at(last).pose);
}

TEST_CASE("memory is bounded") {
  PriorBuffer buffer = filled(100, 100000);  // 10 kHz for 10 s
  CHECK(buffer.at(kFirstSample + 9999900).pose);
  CHECK_FALSE(buffer.at(kFirstSample + 9000000).pose);  // 4096 samples are 0.4 s
}
