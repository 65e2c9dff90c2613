// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <random>
#include <string>

#include "../trials.hpp"
#include "cloud_samples.hpp"
#include "geometry/linear.hpp"
#include "icp/cloud_alignment.hpp"

using namespace scanlock;
using namespace scanlock::test;

TEST_CASE("the normalised error squared is that of six degrees of freedom over many noisy trials" *
          doctest::test_suite("many trials")) {
  const Pose truth = motion({0.03, -0.02, 0.01}, {0.004, -0.003, 0.01});
  struct Setting {
    std::size_t points;
    double noise;
  };
  for (const Setting setting : {Setting{1500, 0.01}, Setting{1500, 0.03}, Setting{4000, 0.01}}) {
    for (const std::string method : {"icp-plane", "robust-icp-plane", "robust-symmetric-icp"}) {
      double sum = 0;
      const int count = trials(40);
      for (int trial = 0; trial < count; ++trial) {
        Random random(static_cast<unsigned>(100 + trial));
        const PointCloud cloud = room(random, setting.points, setting.noise);
        const PointCloud other = room(random, setting.points, setting.noise);
        CloudTarget target(cloud);
        target.prepare_normals();
        const CloudAlignment result =
            align_clouds(moved(other, truth.inverse()), target, Pose::Identity(), *find_cloud_method(method));
        const Vector6 error = se3_log(result.target_from_source.inverse() * truth);
        sum += error.dot(solve(result.covariance, error));
      }
      const double nees = sum / count;
      CAPTURE(method);
      CAPTURE(setting.points);
      CAPTURE(setting.noise);
      INFO("NEES " << nees << " of 6");
      // The variance is at most a factor of two too small, and not uselessly large.
      CHECK(nees > 1.0);
      CHECK(nees < 12.0);
    }
  }
}

TEST_CASE("errors that neighbouring points share keep the NEES between 1 and 12" *
          doctest::test_suite("many trials")) {
  // All points of a cell of half a metre have a common error along their normals, in each cloud.
  const Pose truth = motion({0.03, -0.02, 0.01}, {0.004, -0.003, 0.01});
  const auto warped = [](unsigned seed) {
    Random random(seed);
    PointCloud cloud = room(random, 6000, 0.002);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const auto cell = [](float v) {
        return static_cast<unsigned>(static_cast<int>(std::floor(2 * v)) + 50);
      };
      std::seed_seq seeds{seed, cell(cloud.x[i]), cell(cloud.y[i]), cell(cloud.z[i])};
      std::mt19937 engine(seeds);
      const float off = 0.01f * std::normal_distribution<float>()(engine);
      cloud.x[i] += off * cloud.nx[i];
      cloud.y[i] += off * cloud.ny[i];
      cloud.z[i] += off * cloud.nz[i];
    }
    return cloud;
  };
  CloudAlignmentOptions options;
  options.nu_min = 0.03;  // above the errors of the surfaces
  for (const std::string method : {"icp-plane", "robust-icp-plane"}) {
    double sum = 0;
    const int count = trials(20);
    for (int trial = 0; trial < count; ++trial) {
      const auto seed = static_cast<unsigned>(2 * trial);
      CloudTarget target(warped(seed));
      target.prepare_normals();
      const CloudAlignment result = align_clouds(moved(warped(seed + 1), truth.inverse()), target,
                                                 Pose::Identity(), *find_cloud_method(method), options);
      const Vector6 error = se3_log(result.target_from_source.inverse() * truth);
      sum += error.dot(solve(result.covariance, error));
    }
    CAPTURE(method);
    INFO("NEES " << sum / count << " of 6");
    CHECK(sum / count > 1.0);
    CHECK(sum / count < 12.0);
  }
}

TEST_CASE("the covariance follows the frame of the source") {
  // The same clouds with another frame of the source: the same motion, in that frame.
  Random random(9);
  const PointCloud cloud = room(random, 2000, 0.01), other = room(random, 2000, 0.01);
  CloudTarget target(cloud);
  target.prepare_normals();
  const CloudMethod method = *find_cloud_method("icp-plane");
  const Pose shift = motion({5, -3, 1}, {0, 0, 0});
  const CloudAlignment here = align_clouds(other, target, Pose::Identity(), method);
  const CloudAlignment there = align_clouds(moved(other, shift.inverse()), target, shift, method);
  const Matrix6 expected = adjoint(shift.inverse()) * here.covariance * adjoint(shift.inverse()).transpose();
  CHECK((there.covariance - expected).norm() < 1e-2 * expected.norm());
}
