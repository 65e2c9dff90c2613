// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <initializer_list>
#include <string>

#include "cloud_samples.hpp"
#include "icp/cloud_alignment.hpp"

using namespace scanlock;
using namespace scanlock::test;

TEST_CASE("the normalised error squared is that of six degrees of freedom over many noisy trials") {
  const Pose truth = motion({0.03, -0.02, 0.01}, {0.004, -0.003, 0.01});
  struct Setting {
    std::size_t points;
    double noise;
  };
  for (const Setting setting : {Setting{1500, 0.01}, Setting{1500, 0.03}, Setting{4000, 0.01}}) {
    for (const std::string method : {"icp-plane", "robust-icp-plane", "robust-symmetric-icp"}) {
      double sum = 0;
      constexpr int kTrials = 40;
      for (int trial = 0; trial < kTrials; ++trial) {
        Random random(static_cast<unsigned>(100 + trial));
        const PointCloud cloud = room(random, setting.points, setting.noise);
        const PointCloud other = room(random, setting.points, setting.noise);
        CloudTarget target(cloud);
        target.prepare_normals();
        const CloudAlignment result =
            align_clouds(moved(other, truth.inverse()), target, Pose::Identity(), *find_cloud_method(method));
        const Vector6 error = se3_log(result.target_from_source.inverse() * truth);
        sum += error.dot(result.covariance.ldlt().solve(error));
      }
      const double nees = sum / kTrials;
      CAPTURE(method);
      CAPTURE(setting.points);
      CAPTURE(setting.noise);
      INFO("NEES " << nees << " of 6");
      // Neither over-confident by more than a factor of two in variance, nor useless.
      CHECK(nees > 1.0);
      CHECK(nees < 12.0);
    }
  }
}

TEST_CASE("the covariance follows the frame of the source") {
  // The same clouds with the source's frame elsewhere: the same motion of the body, seen from there.
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
