// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of clouds that are unsuitable for an alignment.
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "cloud_samples.hpp"
#include "icp/cloud_alignment.hpp"

using namespace scanlock;
using namespace scanlock::test;

namespace {

/// Runs every method and checks that the result is a rigid transform; then calls `check`.
template <typename Check>
void with_every_method(const PointCloud& source, const PointCloud& cloud, const Check& check) {
  CloudTarget target(cloud);
  target.prepare_normals();
  for (const std::string& method : cloud_method_names()) {
    CAPTURE(method);
    const CloudAlignment result = align_clouds(source, target, Pose::Identity(), *find_cloud_method(method));
    const Eigen::Matrix3d r = result.target_from_source.linear();
    CHECK(result.target_from_source.matrix().allFinite());
    CHECK((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-9);
    CHECK(result.covariance.allFinite());
    CHECK(std::isfinite(result.energy));
    check(result);
  }
}

PointCloud line(std::size_t n) {
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) cloud.push_back(0.1f * static_cast<float>(i), 1, 2);
  return cloud;
}

}  // namespace

TEST_CASE("clouds of fewer than three finite points are refused with a message") {
  Random random(1);
  const PointCloud good = room(random, 100);
  const CloudTarget target(good);
  const CloudMethod method = *find_cloud_method("robust-icp");
  for (std::size_t n = 0; n < 3; ++n) {
    PointCloud few = line(n);
    few.push_back(NAN, 0, 0);
    few.push_back(0, INFINITY, 0);
    const std::string words = std::to_string(n) + " finite points; an alignment takes at least 3";
    CHECK_THROWS_WITH_AS(CloudTarget{few}, words.c_str(), std::invalid_argument);
    CHECK_THROWS_WITH_AS(align_clouds(few, target, Pose::Identity(), method), words.c_str(),
                         std::invalid_argument);
  }
  CHECK_THROWS_AS(align_clouds(good, target, Pose::Identity(), *find_cloud_method("icp-plane")),
                  std::invalid_argument);
}

TEST_CASE("three points, equal points and a line are degenerate") {
  PointCloud equal;
  for (int i = 0; i < 50; ++i) equal.push_back(1, 2, 3);
  for (const PointCloud& cloud : {line(3), equal, line(100)}) {
    PointCloud source = cloud;
    for (float& x : source.x) x += 0.02f;
    with_every_method(source, cloud, [](const CloudAlignment& result) {
      CHECK(result.stop_reason == "degenerate");
      CHECK(result.degenerate_axes != 0);
    });
  }
}

TEST_CASE("a plane leaves two translations and a rotation open") {
  Random random(2);
  PointCloud plane, other;
  for (int i = 0; i < 2000; ++i) {
    plane.push_back(static_cast<float>(random.between(-3, 3)), static_cast<float>(random.between(-3, 3)), 1);
    other.push_back(static_cast<float>(random.between(-3, 3)), static_cast<float>(random.between(-3, 3)),
                    1.1f);
  }
  with_every_method(other, plane, [](const CloudAlignment& result) {
    CHECK(result.degenerate_axes == 0b100011);  // x, y, and the rotation about z
    CHECK(result.covariance(0, 0) > 100 * result.covariance(2, 2));
  });
  CloudTarget target(plane);
  target.prepare_normals();
  const CloudAlignment result =
      align_clouds(other, target, Pose::Identity(), *find_cloud_method("robust-icp-plane"));
  CHECK(result.target_from_source.translation().z() == doctest::Approx(-0.1).epsilon(1e-3));
}

TEST_CASE("points that are not finite are left out") {
  Random random(3);
  const PointCloud cloud = room(random, 2000);
  const Pose truth = motion({0.05, 0, 0}, {0, 0, 0.02});
  PointCloud source = moved(cloud, truth.inverse()), target = cloud;
  for (std::size_t i = 0; i < 2000; i += 10) {
    source.x[i] = NAN;
    source.nx[i + 1] = NAN;
    target.y[i + 2] = INFINITY;
    target.nz[i + 3] = NAN;
  }
  with_every_method(source, target, [&](const CloudAlignment& result) {
    CHECK((result.target_from_source.translation() - truth.translation()).norm() < 0.02);
  });
}

TEST_CASE("normals that are zero or not of unit length are corrected") {
  Random random(4);
  const PointCloud cloud = room(random, 3000);
  PointCloud bad = cloud;
  for (std::size_t i = 0; i < bad.size(); ++i) {
    const float scale = i % 3 == 0 ? 0.0f : i % 3 == 1 ? 7.0f : -0.01f;
    bad.nx[i] *= scale;
    bad.ny[i] *= scale;
    bad.nz[i] *= scale;
  }
  const Pose truth = motion({0.05, 0.03, 0}, {0, 0, 0.02});
  with_every_method(moved(bad, truth.inverse()), bad, [&](const CloudAlignment& result) {
    CHECK((result.target_from_source.translation() - truth.translation()).norm() < 1e-3);
  });
}

TEST_CASE("far from the origin the alignment is as good as the floats of the cloud") {
  Random random(5);
  // At 1e7 m the resolution of a float is 1 m: a scene of that scale, to be aligned to a few metres.
  const PointCloud small = room(random, 3000);
  PointCloud far, source;
  for (std::size_t i = 0; i < small.size(); ++i) {
    const Eigen::Vector3d p = 100.0 * small.point(i).cast<double>() + Eigen::Vector3d(1e7, -1e7, 0);
    far.push_back(Eigen::Vector3f(p.cast<float>()));
    source.push_back(Eigen::Vector3f((p + Eigen::Vector3d(8, 4, 2)).cast<float>()));
  }
  with_every_method(source, far, [&](const CloudAlignment& result) {
    const Eigen::Vector3d p(1e7, -1e7, 100);
    CHECK((result.target_from_source * p - (p - Eigen::Vector3d(8, 4, 2))).norm() < 2.0);
  });
}

TEST_CASE("distant clouds give a finite result") {
  Random random(6);
  const PointCloud target = room(random, 1000);
  PointCloud source = room(random, 1000);
  for (float& x : source.x) x += 1e4f;
  with_every_method(source, target, [](const CloudAlignment&) {});
}

TEST_CASE("clouds that never overlap have a low inlier ratio or are degenerate") {
  Random random(7);
  const PointCloud target = room(random, 2000);
  PointCloud source;  // a distant ball of ten metres
  for (int i = 0; i < 2000; ++i)
    source.push_back(Eigen::Vector3f((10.0 * random.vector().normalized()).cast<float>()) +
                     Eigen::Vector3f(1e3f, 0, 0));
  with_every_method(source, target, [](const CloudAlignment& result) {
    CHECK((result.inlier_ratio < 0.2 || result.stop_reason == "degenerate"));
  });
}
