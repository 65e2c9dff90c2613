// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/cloud_alignment.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "../trials.hpp"
#include "cloud_samples.hpp"
#include "geometry/angles.hpp"
#include "icp/welsch.hpp"

using namespace scanlock;
using namespace scanlock::test;

namespace {

CloudTarget ready(const PointCloud& cloud) {
  CloudTarget target(cloud);
  target.prepare_normals();
  return target;
}

CloudAlignment align(const PointCloud& source, const CloudTarget& target, const std::string& method,
                     const Pose& start = Pose::Identity()) {
  return align_clouds(source, target, start, *find_cloud_method(method));
}

double rotation_error(const Pose& a, const Pose& b) {
  return so3_log((a.inverse() * b).linear()).norm();
}
double translation_error(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm();
}

}  // namespace

TEST_CASE("every method finds a moderate motion of one and the same points") {
  Random random(1);
  const PointCloud cloud = room(random, 4000);
  const Pose truth = motion({0.1, -0.07, 0.05}, {0.02, -0.03, 0.06});
  const PointCloud source = moved(cloud, truth.inverse());
  const CloudTarget target = ready(cloud);
  for (const std::string& method : cloud_method_names()) {
    CAPTURE(method);
    const CloudAlignment result = align(source, target, method);
    CHECK(result.stop_reason == "converged");
    CHECK(rotation_error(result.target_from_source, truth) < 1e-4);
    CHECK(translation_error(result.target_from_source, truth) < 1e-3);
    CHECK(result.inlier_ratio > 0.99);
    CHECK(result.degenerate_axes == 0);
  }
}

TEST_CASE("a small yaw is found to one percent from identity") {
  Random random(2);
  const PointCloud cloud = room(random, 6000);
  const CloudTarget target = ready(cloud);
  for (const double degrees : {0.05, 0.1, 0.2}) {
    const Pose truth = motion(Eigen::Vector3d::Zero(), {0, 0, degrees * kDegree});
    const PointCloud source = moved(cloud, truth.inverse());
    for (const char* method : {"robust-icp", "robust-icp-plane"}) {
      CAPTURE(method);
      const Pose found = align(source, target, method).target_from_source;
      CHECK(rotation_error(found, truth) < 0.01 * degrees * kDegree);
    }
  }
}

TEST_CASE("a small yaw is found to one percent where source and target are different samples") {
  Random random(3);
  const PointCloud target_cloud = room(random, 20000), other = room(random, 20000);
  const CloudTarget target = ready(target_cloud);
  for (const double degrees : {0.05, 0.1, 0.2}) {
    const Pose truth = motion(Eigen::Vector3d::Zero(), {0, 0, degrees * kDegree});
    const Pose found = align(moved(other, truth.inverse()), target, "robust-icp-plane").target_from_source;
    CHECK(rotation_error(found, truth) < 0.01 * degrees * kDegree);
  }
}

TEST_CASE("robust methods ignore points that only one of the clouds has") {
  for (int seed = 0; seed < trials(6); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<unsigned>(seed));
    const PointCloud all = room(random, 8000), other = room(random, 8000);
    // A third of the target is missing, and a fifth of the source is clutter.
    PointCloud part;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all.x[i] < 1.5f) part.push_back(all.point(i));
    }
    const Pose truth = motion({0.2, 0.15, -0.05}, {0.01, 0.02, -0.08});
    PointCloud source = moved(other, truth.inverse());
    source.nx.clear();
    source.ny.clear();
    source.nz.clear();
    for (int i = 0; i < 2000; ++i) source.push_back(Eigen::Vector3f((3.0 * random.vector()).cast<float>()));
    const CloudTarget target = ready(part);
    const double plain = translation_error(align(source, target, "icp").target_from_source, truth);
    CHECK(plain > 0.05);
    CHECK(translation_error(align(source, target, "robust-icp").target_from_source, truth) < 0.02);
    CHECK(translation_error(align(source, target, "robust-icp-plane").target_from_source, truth) < 0.005);
    CHECK(translation_error(align(source, target, "robust-symmetric-icp").target_from_source, truth) < 0.005);
  }
}

TEST_CASE("acceleration finds the minimum of the plain method in fewer sweeps") {
  Random random(5);
  const PointCloud cloud = room(random, 3000), other = room(random, 3000);
  const CloudTarget target = ready(cloud);
  const PointCloud source = moved(other, motion({0.3, -0.2, 0.1}, {0.05, 0.0, 0.15}));
  const CloudAlignment plain = align(source, target, "icp"), fast = align(source, target, "fast-icp");
  CHECK(fast.sweeps < plain.sweeps);
  CHECK(fast.energy < plain.energy * 1.001);
  CHECK(translation_error(plain.target_from_source, fast.target_from_source) < 0.01);
}

TEST_CASE("a rotation near half a turn is found from a start beside it") {
  Random random(6);
  const PointCloud cloud = room(random, 4000);
  const Pose truth = motion({1, 2, 0.5}, {0, 0, 179.9 * kDegree});
  const Pose start = motion({1.05, 1.95, 0.5}, {0, 0, -179 * kDegree});
  const CloudTarget target = ready(cloud);
  for (const char* method : {"fast-icp", "robust-icp", "robust-icp-plane", "robust-symmetric-icp"}) {
    CAPTURE(method);
    const Pose found = align(moved(cloud, truth.inverse()), target, method, start).target_from_source;
    CHECK(rotation_error(found, truth) < 1e-4);
  }
}

TEST_CASE("threads do not change a bit of the result") {
  Random random(7);
  const PointCloud cloud = room(random, 5000, 0.01), other = room(random, 5000, 0.01);
  const PointCloud source = moved(other, motion({0.1, 0, 0}, {0, 0, 0.05}));
  const CloudTarget target = ready(cloud);
  for (const char* method : {"robust-icp", "robust-icp-plane", "robust-symmetric-icp"}) {
    CloudAlignmentOptions options;
    const CloudAlignment one =
        align_clouds(source, target, Pose::Identity(), *find_cloud_method(method), options);
    options.threads = 3;
    const CloudAlignment three =
        align_clouds(source, target, Pose::Identity(), *find_cloud_method(method), options);
    CHECK(one.target_from_source.matrix() == three.target_from_source.matrix());
    CHECK(one.covariance == three.covariance);
    CHECK(one.searches_made == three.searches_made);
  }
}

TEST_CASE("nu follows the rules of the paper, and can be fixed") {
  PointCloud grid;  // spacing 0.1: a point has four neighbours at 0.1, and the next ones at 0.1414
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j)
      grid.push_back(0.1f * static_cast<float>(i), 0.1f * static_cast<float>(j), 0);
  }
  const CloudTarget target = ready(grid);
  CHECK(target.spacing() == doctest::Approx(0.1).epsilon(1e-4));
  CHECK(target.point_nu_min() == doctest::Approx(0.1 / (3 * std::sqrt(3.0))).epsilon(1e-4));
  PointCloud source = grid;
  for (float& z : source.z) z += 0.04f;
  const CloudAlignment by_rule = align(source, target, "robust-icp");
  CHECK(by_rule.nu_max == doctest::Approx(3 * 0.04).epsilon(1e-3));
  CHECK(by_rule.nu_min == doctest::Approx(target.point_nu_min()));
  PointCloud aside = grid;
  for (float& x : aside.x) x += 0.02f;
  const CloudAlignment planes = align(aside, target, "robust-icp-plane");
  // From point-to-point distances also for planes.
  CHECK(planes.nu_max == doctest::Approx(3 * 0.02).epsilon(1e-3));
  CHECK(planes.nu_min == doctest::Approx(target.plane_nu_min()));
  CloudAlignmentOptions options;
  options.nu_max = 0.5;
  options.nu_min = 0.25;
  const CloudAlignment fixed =
      align_clouds(source, target, Pose::Identity(), *find_cloud_method("robust-icp"), options);
  CHECK(fixed.nu_max == 0.5);
  CHECK(fixed.nu_min == 0.25);
}

TEST_CASE("the step of each energy is half of Newton's direction downhill") {
  // The gradient of plane_step against the numeric derivative of the energy: with fixed pairs, the derivative
  // of the robust energy along the step is negative, and it vanishes at the minimum.
  Random random(8);
  const PointCloud cloud = room(random, 3000, 0.01), other = room(random, 3000, 0.01);
  const CloudTarget target = ready(cloud);
  for (const IcpObjective objective :
       {IcpObjective::kPoint, IcpObjective::kPlane, IcpObjective::kSymmetric}) {
    CloudProblem problem(other, target, {objective, MotionCoordinates::kLieAlgebra, true, 1});
    const StateVector x = problem.begin(motion({0.02, 0.01, 0}, {0, 0.003, 0.004}), 0.1, 1.0);
    const double energy = problem.evaluate(x);
    const StateVector step = problem.image() - x;
    const double h = 1e-3;
    const double slope = (problem.evaluate(x + h * step) - energy) / h;
    CHECK(slope < 0);
    CHECK(problem.evaluate(x + step) < energy);
  }
}

TEST_CASE("names of methods") {
  CHECK(cloud_method_names().size() == 9);
  CHECK_FALSE(find_cloud_method("4dof").has_value());
  CHECK_FALSE(find_cloud_method("").has_value());
  CHECK(find_cloud_method("aa-icp")->coordinates == MotionCoordinates::kEulerAngles);
}

namespace {

/// The scan, in rings, of a sensor with 24 beams at `eye`, 1.8 m above the floor of a hall of 30 m by 20 m.
PointCloud rings(const Eigen::Vector3d& eye) {
  PointCloud cloud;
  for (int beam = 0; beam < 24; ++beam) {
    const double elevation = -0.4 + 0.02 * beam;
    for (int step = 0; step < 360; ++step) {
      const double azimuth = step * kDegree;
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      double range = ray.z() < 0 ? (-1.8 - eye.z()) / ray.z() : 1e9;
      range = std::min(range, (std::copysign(15.0, ray.x()) - eye.x()) / ray.x());
      range = std::min(range, (std::copysign(10.0, ray.y()) - eye.y()) / ray.y());
      cloud.push_back((range * ray).cast<float>());
    }
  }
  return cloud;
}

}  // namespace

TEST_CASE("with start_may_be_better the rings of a scan do not move the pose away from a right start") {
  const Pose truth = motion({0.3, 0.1, 0}, {0, 0, 0});
  const PointCloud source = rings(truth.translation());
  CloudTarget target(rings(Eigen::Vector3d::Zero()));
  target.prepare_normals();
  const CloudMethod method = *find_cloud_method("robust-icp");
  CloudAlignmentOptions options;
  options.nu_max = 0.3;
  const auto error = [&](const Pose& start) {
    const Pose found = align_clouds(source, target, start, method, options).target_from_source;
    return (found.translation() - truth.translation()).norm();
  };
  CHECK(error(truth) > 0.02);
  options.start_may_be_better = true;
  CHECK(error(truth) < 0.001);
  CHECK(align_clouds(source, target, truth, method, options).stop_reason == "start");
  CHECK_THROWS_AS(align_clouds(source, CloudTarget(source), truth, method, options), std::invalid_argument);
}

TEST_CASE("a start that is kept is refined on the planes") {
  const Pose truth = motion({0.3, 0.1, 0}, {0, 0, 0});
  const PointCloud source = rings(truth.translation());
  CloudTarget target(rings(Eigen::Vector3d::Zero()));
  target.prepare_normals();
  CloudAlignmentOptions options;
  options.nu_max = 0.3;
  options.start_may_be_better = true;
  const CloudAlignment found = align_clouds(source, target, motion({0.304, 0.097, 0.003}, {0, 0, 0.001}),
                                            *find_cloud_method("robust-icp"), options);
  CHECK(found.stop_reason == "start");
  CHECK((found.target_from_source.translation() - truth.translation()).norm() < 0.001);
}

TEST_CASE("with start_may_be_better a start that is worse than the result is not kept") {
  Random random(3);
  const PointCloud cloud = room(random, 6000, 0.003);
  CloudAlignmentOptions options;
  options.nu_max = 0.3;
  options.start_may_be_better = true;
  const Pose truth = motion({0.1, 0.05, 0}, {0, 0, 0.02});
  const CloudAlignment found = align_clouds(moved(cloud, truth.inverse()), ready(cloud), Pose::Identity(),
                                            *find_cloud_method("robust-icp"), options);
  CHECK(found.stop_reason == "converged");
  CHECK(translation_error(found.target_from_source, truth) < 0.005);
}

TEST_CASE("a scan that is dense near its sensor is not degenerate") {
  const auto scan = [](unsigned seed) {
    Random random(seed);
    PointCloud cloud = room(random, 3000, 0.002);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      cloud.x[i] *= 5;
      cloud.y[i] *= 5;
      cloud.z[i] *= 5;
    }
    for (int i = 0; i < 30000; ++i) {
      cloud.push_back(static_cast<float>(random.between(-1, 1)), static_cast<float>(random.between(-1, 1)),
                      static_cast<float>(0.002 * random.number()));
    }
    cloud.nx.clear();
    cloud.ny.clear();
    cloud.nz.clear();
    return cloud;
  };
  CloudTarget target(scan(1));
  const PointCloud source = moved(scan(2), motion({0.02, 0.01, 0}, {0, 0, 0.001}));
  CHECK(align(source, target, "robust-icp").degenerate_axes == 0);
  target.prepare_normals();
  CHECK(align(source, target, "robust-icp-plane").degenerate_axes == 0);
}
