// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/tracking_promise.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <random>

namespace scanlock {

TEST_CASE("one normal vector in a hundred exceeds the bound, whatever its covariance") {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (const Eigen::Vector3d& sigmas :
       {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(1, 0, 0),
        Eigen::Vector3d(3, 1, 0.5), Eigen::Vector3d(1, 0.6, 0.3)}) {
    const Eigen::Matrix3d covariance = sigmas.cwiseAbs2().asDiagonal();
    const double bound = squared_bound(covariance);
    int beyond = 0;
    const int trials = 100000;
    for (int i = 0; i < trials; ++i)
      beyond +=
          sigmas.cwiseProduct(Eigen::Vector3d(normal(random), normal(random), normal(random))).squaredNorm() >
          bound;
    CAPTURE(sigmas.transpose());
    CHECK(beyond > 0.008 * trials);
    CHECK(beyond < 0.012 * trials);
  }
  CHECK(squared_bound(Eigen::Matrix3d::Zero()) == 0.0);
}

TEST_CASE(
    "axes beyond the bounds of TRACKING are unknown, and the worst axis if only all together exceed them") {
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal() << 1e-6, 0.1, 1e-6, 1e-8, 1e-8, 1.0;
  CHECK(unknown_axes(covariance, 0x3f) == 0b100010u);
  CHECK(unknown_axes(covariance, 0b011111) == 0b000010u);
  // Each axis alone is within 0.05 m with a probability of 99 %, the three together are not.
  covariance.diagonal() << 0.0187 * 0.0187, 0.0186 * 0.0186, 0.0186 * 0.0186, 1e-8, 1e-8, 1e-8;
  CHECK(unknown_axes(covariance, 0x3f) == 0b000001u);
  covariance.topLeftCorner<3, 3>() *= 0.5;
  CHECK(unknown_axes(covariance, 0x3f) == 0u);
  covariance(0, 0) = std::numeric_limits<double>::quiet_NaN();
  CHECK((unknown_axes(covariance, 0x3f) & 1u) == 1u);
  // With wider bounds than those of TRACKING: a standard deviation of 0.1 m is within 0.5 m.
  covariance = Matrix6::Zero();
  covariance(0, 0) = 0.1 * 0.1;
  CHECK(unknown_axes(covariance, 0x3f) == 1u);
  CHECK(unknown_axes(covariance, 0x3f, 0.5, 0.05) == 0u);
}

}  // namespace scanlock
