// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/bounds/angle_stabbing.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "geometry/angles.hpp"

namespace scanlock {
namespace {

/// The same as reach_of(), by the chord: |R(theta) p - q|.
double distance_at(double p_length, double p_azimuth, double q_length, double q_azimuth, double theta) {
  return std::hypot(p_length * std::cos(p_azimuth + theta) - q_length * std::cos(q_azimuth),
                    p_length * std::sin(p_azimuth + theta) - q_length * std::sin(q_azimuth));
}

bool holds(const AngleInterval& interval, double theta) {
  double offset = std::fmod(theta - interval.start, 2 * kPi);
  if (offset < 0) offset += 2 * kPi;
  return offset <= interval.width;
}

TEST_CASE("Intervals hold the angles that bring p within e of q, and no others") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> length(0.1, 3), angle(-4, 4), unit(0, 1);
  for (int i = 0; i < 20000; ++i) {
    const double p = length(random), q = length(random), pa = angle(random), qa = angle(random);
    const double e = unit(random) * 2, theta = angle(random);
    AngleInterval interval;
    const AngleReach reach = reach_of(p, pa, q, qa, e, interval);
    const double d = distance_at(p, pa, q, qa, theta);
    if (std::abs(d - e) < 1e-9) continue;
    const bool held =
        reach == AngleReach::kAlways || (reach == AngleReach::kInterval && holds(interval, theta));
    REQUIRE(held == (d < e));
  }
}

TEST_CASE("The width of an interval follows from the squared threshold") {
  // p and q one metre from the axis, e = 0.1: the half angle is 2 asin(e / 2), not acos((2 - 0.1) / 2).
  AngleInterval interval;
  REQUIRE(reach_of(1, 0, 1, 1, 0.1, interval) == AngleReach::kInterval);
  CHECK(interval.width == doctest::Approx(4 * std::asin(0.05)).epsilon(1e-9));
  CHECK(interval.start + 0.5 * interval.width == doctest::Approx(1));
}

TEST_CASE("Points on the axis are reached by all angles or by none") {
  AngleInterval interval;
  CHECK(reach_of(0, 0, 0.05, 1, 0.1, interval) == AngleReach::kAlways);
  CHECK(reach_of(0, 0, 0.15, 1, 0.1, interval) == AngleReach::kNever);
  CHECK(reach_of(0.05, 2, 0, 0, 0.1, interval) == AngleReach::kAlways);
  CHECK(reach_of(0, 0, 0, 0, 0, interval) == AngleReach::kAlways);
  CHECK(reach_of(0.1, 2, 0, 0, 0.1, interval) == AngleReach::kAlways);  // the ball just reaches it
}

TEST_CASE("Stabbing handles intervals across 2 pi") {
  AngleStabber stabber;
  stabber.add({2 * kPi - 0.2, 0.3});  // to 0.1
  stabber.add({0.05, 0.5});           // from 0.05
  stabber.add({2 * kPi - 0.1, 0.2});  // to 0.1
  stabber.add({3, 0.5});
  double theta = 0;
  CHECK(stabber.stab(theta) == 3);
  CHECK(theta >= 0.05);
  CHECK(theta <= 0.1);
  stabber.clear();
  stabber.add({2 * kPi - 0.2, 0.2});  // ends at 2 pi, where the next interval begins
  stabber.add({0, 0.1});
  CHECK(stabber.stab(theta) == 2);
}

TEST_CASE("Touching intervals share their end") {
  AngleStabber stabber;
  stabber.add({1, 0.5});
  stabber.add({1.5, 0.5});
  stabber.add({2, 1});
  double theta = 0;
  CHECK(stabber.stab(theta) == 2);
  CHECK(theta == doctest::Approx(1.5));
}

TEST_CASE("Stabbing agrees with trying every end") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> angle(0, 2 * kPi), width(0, 3);
  for (int i = 0; i < 300; ++i) {
    AngleStabber stabber;
    std::vector<AngleInterval> intervals;
    for (int k = 0; k < 1 + i % 20; ++k) {
      intervals.push_back({angle(random), width(random)});
      stabber.add(intervals.back());
    }
    const auto depth = [&](double theta) {
      int count = 0;
      for (const AngleInterval& interval : intervals) count += holds(interval, theta);
      return count;
    };
    int expected = 0;
    for (const AngleInterval& interval : intervals) expected = std::max(expected, depth(interval.start));
    double theta = 0;
    REQUIRE(stabber.stab(theta) == expected);
    REQUIRE(depth(theta) == expected);
  }
  AngleStabber none;
  double theta = 0;
  CHECK(none.stab(theta, 1.25) == 0);
  CHECK(theta == 1.25);
}

}  // namespace
}  // namespace scanlock
