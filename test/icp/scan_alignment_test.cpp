// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/scan_alignment.hpp"

#include <doctest/doctest.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include "../odometry/room.hpp"
#include "geometry/angles.hpp"
#include "icp/scan_motion.hpp"

namespace scanlock {
namespace {

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

TEST_CASE("a thin wall seen only from its other side does not pull a scan onto that side") {
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0, 0.01f);
  std::uniform_real_distribution<float> across(-3, 3), up(-1, 1);
  const auto add_wall = [&](PointCloud& cloud, float x, int points) {
    for (int i = 0; i < points; ++i) cloud.push_back(x + noise(random), across(random), up(random));
  };
  const auto room = [&](int density) {  // a floor, two walls along x, and one wall across far ahead
    PointCloud cloud;
    for (int i = 0; i < density; ++i) {
      cloud.push_back(across(random), across(random), -1 + noise(random));
      cloud.push_back(across(random), -3 + noise(random), up(random));
      cloud.push_back(across(random), 3 + noise(random), up(random));
    }
    add_wall(cloud, 5, density / 5);
    return cloud;
  };
  PointCloud map = room(4000), scan = room(400);
  add_wall(scan, -3, 400);
  map.viewpoints.assign(map.size(), Eigen::Vector3f::Zero());
  const auto x_with_wall_seen_from = [&](float eye) {
    PointCloud all = map;
    add_wall(all, -3.12f, 4000);
    all.viewpoints.resize(all.size(), {eye, 0, 0});
    KdForest tree;
    tree.rebuild(all);
    LocalSurfaces surfaces;
    surfaces.reset(all, tree, 0.4f);
    const AlignmentTarget target{all, tree, surfaces};
    return ScanAligner().align(scan, target, weak_prior(), {}).moving.pose.translation().x();
  };
  CHECK(std::abs(x_with_wall_seen_from(-6)) < 0.01);
  CHECK(x_with_wall_seen_from(0) < -0.08);  // a wall that has moved
}

TEST_CASE("the variance of a scan's acceleration is that of a parabola fitted to white-noise acceleration") {
  constexpr int kTimes = 400, kImpulses = 400;
  const double seconds = 0.2;
  Eigen::MatrixXd way(kTimes, kImpulses), model(kTimes, 3);
  for (int i = 0; i < kTimes; ++i) {
    const double t = (i + 0.5) / kTimes * seconds;
    model.row(i) << 1, t, bend_at(t, seconds / 2);
    for (int k = 0; k < kImpulses; ++k) way(i, k) = std::max(t - (k + 0.5) / kImpulses * seconds, 0.0);
  }
  const Eigen::MatrixXd fit = model.colPivHouseholderQr().solve(way);
  const double variance = fit.row(2).squaredNorm() * seconds / kImpulses;
  CHECK(variance == doctest::Approx(acceleration_variance(seconds)).epsilon(1e-3));
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

TEST_CASE("the acceleration within a sweep is estimated from one scan, if the prior allows an acceleration") {
  Hall hall;
  Vector6 twist, acceleration, start;
  twist << 3.0, -0.5, 0.2, 0.1, -0.1, 1.5;
  acceleration << -8.0, 4.0, 2.0, 3.0, -2.0, 12.0;
  start << 0.1, -0.05, 0.02, 0.01, -0.01, 0.03;
  for (const double stamp : {0.0, 0.05, 0.1}) {  // seconds after the first point
    CAPTURE(stamp);
    Scan scan = hall_scan(se3_exp(start), Vector6::Zero(), 0, 3);
    PointCloud& points = scan.points;
    for (float& t : points.time) t -= static_cast<float>(stamp);
    const auto [first, last] = std::minmax_element(points.time.begin(), points.time.end());
    const double middle = 0.5 * (*first + *last);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double t = points.time[i];
      const Eigen::Vector3d p =
          se3_exp(-(t * twist + bend_at(t, middle) * acceleration)) * points.point(i).cast<double>();
      points.x[i] = static_cast<float>(p.x());
      points.y[i] = static_cast<float>(p.y());
      points.z[i] = static_cast<float>(p.z());
    }
    ScanAlignmentOptions options;
    options.max_iterations = 60;
    options.tolerance = 1e-5;
    MotionPrior free = weak_prior();
    free.acceleration_density.setConstant(700);
    const ScanAlignment found = ScanAligner().align(points, hall.target(), free, options);
    const double off = se3_log(se3_exp(start).inverse() * found.moving.pose).norm();
    CHECK(off < 5e-3);
    CHECK((found.moving.twist - twist).norm() < 0.05);
    CHECK((found.moving.acceleration - acceleration).norm() < 2.0);
    CHECK(found.moving.middle_s == doctest::Approx(middle).epsilon(1e-3));
    const MovingPose truth{Pose::Identity(), twist, acceleration, middle};
    for (const std::size_t i : {std::size_t{0}, points.size() / 2, points.size() - 1})
      CHECK((deskewed(points, found.moving).point(i) - deskewed(points, truth).point(i)).norm() < 0.02f);

    const ScanAlignment steady = ScanAligner().align(points, hall.target(), weak_prior(), options);
    CHECK(steady.moving.acceleration.norm() < 1e-3);
    CHECK(se3_log(se3_exp(start).inverse() * steady.moving.pose).norm() > 2 * off);
    // The uncertainty of the acceleration increases that of the pose.
    const Matrix6 with = inverse(found.information).topLeftCorner<6, 6>(),
                  without = inverse(steady.information).topLeftCorner<6, 6>();
    for (int k = 0; k < 6; ++k) CHECK(with(k, k) > 1.05 * without(k, k));
  }
}

TEST_CASE("a strong prior overrides the data, and a weak prior yields to them") {
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

TEST_CASE("along a smooth pipe the information equals the expected noise") {
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

TEST_CASE(
    "the scatter over patches is the variance of the alignment where points of a patch share an error") {
  Hall hall;
  // Metres; `shared` and `own`: errors of a point along its ray.
  const double patch = 4.0, shared = 0.02, own = 0.01;
  ScanAlignmentOptions options;
  options.nu_min = 0.1;
  options.patch = patch;
  options.max_iterations = 40;
  options.tolerance = 1e-5;
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, 1.0);
  Vector6 sum = Vector6::Zero(), predicted = Vector6::Zero(), independent = Vector6::Zero();
  const int trials = 60;
  for (int trial = 0; trial < trials; ++trial) {
    Scan scan = hall_scan(Pose::Identity(), Vector6::Zero(), 0, 11, 0.1, 2500);
    scan.points.time.clear();
    std::map<std::array<int, 3>, double> errors;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const Eigen::Vector3f p = scan.points.point(i);
      const std::array<int, 3> cell{static_cast<int>(std::floor(p.x() / patch)),
                                    static_cast<int>(std::floor(p.y() / patch)),
                                    static_cast<int>(std::floor(p.z() / patch))};
      if (errors.count(cell) == 0) errors[cell] = shared * normal(random);
      const double off = errors[cell] + own * normal(random);
      const Eigen::Vector3f moved = p * (1.0f + static_cast<float>(off) / p.norm());
      scan.points.x[i] = moved.x();
      scan.points.y[i] = moved.y();
      scan.points.z[i] = moved.z();
    }
    ScanAligner aligner;
    const ScanAlignment found = aligner.align(scan.points, hall.target(), weak_prior(), options);
    double squares = 0;
    for (const float r : aligner.residuals()) squares += std::isnan(r) ? 0.0 : static_cast<double>(r) * r;
    sum += se3_log(found.moving.pose).cwiseAbs2() / trials;
    CHECK(found.curvature < 1.0);
    CHECK(found.curvature > 0.7);
    const Matrix6 bread = inverse(Matrix6(found.curvature * found.information.topLeftCorner<6, 6>()));
    predicted += (bread * found.scatter.topLeftCorner<6, 6>() * bread).diagonal() / trials;
    independent += squares / found.matched * bread.diagonal() / trials;
  }
  for (int axis = 0; axis < 6; ++axis) {
    CAPTURE(axis);
    CHECK(predicted[axis] > 0.4 * sum[axis]);
    CHECK(predicted[axis] < 2.5 * sum[axis]);
    // The variance by independent errors of points is too small.
    if (axis < 3) CHECK(independent[axis] < 0.5 * sum[axis]);
  }
}

}  // namespace scanlock
