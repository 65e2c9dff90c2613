// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/health.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "odometry/odometer.hpp"

namespace {

using namespace scanlock;

constexpr double kScale = 0.05;  // metres

/// The health of points in patches of ten that share the error of their surface; the share `off` of the
/// patches lies two scales off their surface.
Health assess(const HealthMonitor& monitor, int points, double off, std::mt19937* random) {
  std::normal_distribution<float> noise(0.0f, 0.3f * static_cast<float>(kScale));
  std::bernoulli_distribution moved(off);
  std::vector<float> residuals;
  for (int patch = 0; patch < points / 10; ++patch) {
    const float residual = noise(*random) + (moved(*random) ? 2.0f * static_cast<float>(kScale) : 0.0f);
    residuals.insert(residuals.end(), 10, residual);
  }
  return monitor.assess(residuals, residuals, std::vector<float>(residuals.size(), 1.0f), kScale,
                        planar_chance(residuals.size()));
}

/// The monitor of a robot at rest: all scans had the same random error, so that their energies hardly differ.
HealthMonitor rested(int points, std::mt19937* random) {
  HealthMonitor monitor;
  Health usual = assess(monitor, points, 0.1, random);
  usual.energy = assess(monitor, 100000, 0.1, random).energy;
  for (int i = 0; i < 30; ++i) monitor.remember(usual);
  return monitor;
}

}  // namespace

TEST_CASE("random scatter of the energy is no jump, for few points as for many") {
  std::mt19937 random(5);
  for (const int points : {100, 200, 1000, 4000}) {
    const HealthMonitor monitor = rested(points, &random);
    for (int trial = 0; trial < 500; ++trial) CHECK(assess(monitor, points, 0.1, &random).score < kJumpScore);
  }
}

TEST_CASE("the energy at a wrong pose is a jump, for few points as for many") {
  std::mt19937 random(6);
  for (const int points : {300, 1000, 4000}) {
    const HealthMonitor monitor = rested(points, &random);
    for (int trial = 0; trial < 100; ++trial) CHECK(assess(monitor, points, 0.8, &random).score > kJumpScore);
  }
}

TEST_CASE("an energy that rises over 22 scans is no jump, and the same rise within one scan is a jump") {
  const auto at_energy = [](const HealthMonitor& monitor, double energy) {
    // A share of all points lies far off: the energy is that share.
    std::vector<float> residuals(1000, 0.0f);
    std::fill_n(residuals.begin(), static_cast<std::ptrdiff_t>(1000 * energy), 10.0f);
    return monitor.assess(residuals, residuals, std::vector<float>(1000, 1.0f), kScale, 0.0);
  };
  // A simulated drive of an HDL-64 from rest into a wood.
  constexpr double kWood[] = {0.026, 0.028, 0.031, 0.033, 0.035, 0.039, 0.041, 0.047, 0.045, 0.048, 0.050,
                              0.058, 0.062, 0.063, 0.067, 0.082, 0.085, 0.107, 0.104, 0.193, 0.194, 0.245};
  HealthMonitor wood, room;
  for (const double energy : kWood) {
    const Health health = at_energy(wood, energy);
    CHECK(health.score < kJumpScore);
    wood.remember(health);
    room.remember(at_energy(room, kWood[0]));
  }
  CHECK(at_energy(room, 0.25).score > kJumpScore);
}

TEST_CASE("the z-score is in units of the chance scatter for few points, and of the least spread for many") {
  std::mt19937 random(7);
  const HealthMonitor few = rested(100, &random), many = rested(4000, &random);
  const Health a = assess(few, 100, 0.5, &random), b = assess(many, 4000, 0.5, &random);
  CHECK(a.score == doctest::Approx((a.energy - a.baseline) / planar_chance(100)));
  CHECK(b.score < (b.energy - b.baseline) / planar_chance(4000));
}
