// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/health.hpp"

#include <doctest/doctest.h>

#include <random>
#include <vector>

#include "odometry/odometer.hpp"

namespace {

using namespace scanlock;

constexpr double kScale = 0.05;  // metres

/// Points in patches of ten, which share the error of their surface; of the patches the share `off` is two
/// scales away from it.
Health assess(const HealthMonitor& monitor, int points, double off, std::mt19937* random) {
  std::normal_distribution<float> noise(0.0f, 0.3f * static_cast<float>(kScale));
  std::bernoulli_distribution moved(off);
  std::vector<float> residuals;
  for (int patch = 0; patch < points / 10; ++patch) {
    const float residual = noise(*random) + (moved(*random) ? 2.0f * static_cast<float>(kScale) : 0.0f);
    residuals.insert(residuals.end(), 10, residual);
  }
  return monitor.assess(residuals, std::vector<float>(residuals.size(), 1.0f), kScale,
                        planar_chance(residuals.size()));
}

/// That of a robot at rest: chance was the same in all scans, so that their energies hardly differ.
HealthMonitor rested(int points, std::mt19937* random) {
  HealthMonitor monitor;
  Health usual = assess(monitor, points, 0.1, random);
  usual.energy = assess(monitor, 100000, 0.1, random).energy;
  for (int i = 0; i < 30; ++i) monitor.remember(usual);
  return monitor;
}

}  // namespace

TEST_CASE("chance does more to the energy of few points and is no jump") {
  std::mt19937 random(5);
  for (const int points : {100, 200, 1000, 4000}) {
    const HealthMonitor monitor = rested(points, &random);
    for (int trial = 0; trial < 500; ++trial) CHECK(assess(monitor, points, 0.1, &random).score < kJumpScore);
  }
}

TEST_CASE("the energy of another place is a jump, for few points as for many") {
  std::mt19937 random(6);
  for (const int points : {300, 1000, 4000}) {
    const HealthMonitor monitor = rested(points, &random);
    for (int trial = 0; trial < 100; ++trial) CHECK(assess(monitor, points, 0.8, &random).score > kJumpScore);
  }
}

TEST_CASE("a rise is measured by what went before alone") {
  std::mt19937 random(7);
  const HealthMonitor few = rested(100, &random), many = rested(4000, &random);
  const Health a = assess(few, 100, 0.5, &random), b = assess(many, 4000, 0.5, &random);
  CHECK(a.score < a.rise);
  CHECK(b.score == b.rise);
}
