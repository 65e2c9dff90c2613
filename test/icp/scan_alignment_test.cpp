// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/scan_alignment.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "../odometry/room.hpp"

namespace scanlock {
namespace {

constexpr double kDegree = 3.14159265358979 / 180.0;

struct Hall {
  PointCloud cloud;
  KdForest tree;
  LocalSurfaces surfaces;
  Hall() {
    cloud = hall_scan(Pose::Identity(), Vector6::Zero(), 0, 1, 0.1, 40000).points;
    tree.rebuild(cloud);
    surfaces.reset(cloud, tree, 0.8f);
  }
  AlignmentTarget target() { return {cloud, tree, surfaces}; }
};

MotionPrior weak_prior() {
  MotionPrior prior;
  prior.information = 1e-4 * Matrix12::Identity();
  return prior;
}

}  // namespace

TEST_CASE("the small rotations between two scans are recovered to one percent") {
  Hall hall;
  ScanAlignmentOptions options;
  options.tolerance = 1e-6;
  options.max_iterations = 50;
  for (double degrees : {0.05, 0.1, 0.2}) {
    Scan scan = hall_scan(se3_exp(yaw(degrees * kDegree)), Vector6::Zero(), 0, 7);
    scan.points.time.clear();
    const ScanAlignment found = ScanAligner().align(scan.points, hall.target(), weak_prior(), options);
    const Vector6 motion = se3_log(found.moving.pose);
    CHECK(motion[5] / kDegree == doctest::Approx(degrees).epsilon(0.01));
    CHECK(motion.head<5>().norm() < 1e-3);
  }
}

TEST_CASE("pose and velocity of a sweep are solved from one scan") {
  Hall hall;
  Vector6 twist;
  twist << 3.0, -0.5, 0.2, 0.1, -0.1, 1.5;
  Vector6 start;
  start << 0.1, -0.05, 0.02, 0.01, -0.01, 0.03;
  const Scan scan = hall_scan(se3_exp(start), twist, 0, 8);
  ScanAlignmentOptions options;
  options.max_iterations = 40;
  const ScanAlignment found = ScanAligner().align(scan.points, hall.target(), weak_prior(), options);
  CHECK((se3_log(se3_exp(start).inverse() * found.moving.pose)).norm() < 5e-3);
  CHECK((found.moving.twist - twist).head<3>().norm() < 0.05);
  CHECK((found.moving.twist - twist).tail<3>().norm() < 0.02);
  CHECK(found.searches_saved > found.searches_made);
}

TEST_CASE("a strong prior holds what the data contradict and a weak one lets go") {
  Hall hall;
  Scan scan = hall_scan(se3_exp(yaw(0.02)), Vector6::Zero(), 0, 9);
  scan.points.time.clear();
  MotionPrior strong = weak_prior();
  strong.information *= 1e12;
  const ScanAlignment held = ScanAligner().align(scan.points, hall.target(), strong, {});
  CHECK(std::abs(se3_log(held.moving.pose)[5]) < 1e-3);
  const ScanAlignment free = ScanAligner().align(scan.points, hall.target(), weak_prior(), {});
  CHECK(se3_log(free.moving.pose)[5] == doctest::Approx(0.02).epsilon(0.02));
}

TEST_CASE("along a smooth pipe the information is the noise that was expected") {
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> noise(0, 0.03);
  const auto pipe = [&](std::size_t points) {
    PointCloud cloud;
    while (cloud.size() < points) {
      const double angle = 3.14159265358979 * uniform(rng), radius = 3 + noise(rng);
      cloud.push_back(static_cast<float>(10 * uniform(rng)), static_cast<float>(radius * std::cos(angle)),
                      static_cast<float>(radius * std::sin(angle)));
    }
    return cloud;
  };
  const PointCloud map = pipe(8000);
  KdForest tree;
  tree.rebuild(map);
  LocalSurfaces surfaces;
  surfaces.reset(map, tree, 0.8f);
  const ScanAlignment found = ScanAligner().align(pipe(2000), {map, tree, surfaces}, weak_prior(), {});
  CHECK(found.noise(0, 0) == doctest::Approx(found.information(0, 0)).epsilon(0.35));
  CHECK(found.noise(0, 0) < 0.02 * found.information(1, 1));
}

}  // namespace scanlock
