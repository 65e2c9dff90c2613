// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/rigid.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "geometry/angles.hpp"
#include "matrix_exponential.hpp"

namespace scanlock {
namespace {

Vector6 random_twist(std::mt19937& rng, double angle) {
  std::normal_distribution<double> normal;
  Vector6 xi;
  for (int i = 0; i < 6; ++i) xi[i] = normal(rng);
  xi.tail<3>() *= angle / xi.tail<3>().norm();
  return xi;
}

}  // namespace

TEST_CASE("the least rotation turns one direction into the other, about an axis perpendicular to both") {
  std::mt19937 rng(2);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d from(normal(rng), normal(rng), normal(rng));
    Eigen::Vector3d to(normal(rng), normal(rng), normal(rng));
    if (trial % 4 == 0) to = from * std::pow(10.0, normal(rng));
    if (trial % 4 == 1) to = -from * std::pow(10.0, normal(rng));
    if (trial % 4 == 2) to = -from + 1e-5 * to;
    const Eigen::Quaterniond q = least_rotation(from, to);
    CHECK(std::abs(q.norm() - 1.0) < 1e-9);
    CHECK((q * from.normalized() - to.normalized()).norm() < 1e-5);
    CHECK(std::abs(q.vec().dot(from.normalized())) < 1e-9);
  }
}

TEST_CASE("exponential of SE3 equals the matrix exponential") {
  std::mt19937 rng(1);
  for (double angle : {0.0, 1e-12, 1e-6, 1e-3, 0.1, 0.49, 0.51, 1.0, 3.0, kPi, 5.0}) {
    const Vector6 xi = angle == 0.0 ? Vector6(Vector6::Zero()) : random_twist(rng, angle);
    CHECK((se3_exp(xi).matrix() - matrix_exponential(as_matrix(xi))).cwiseAbs().maxCoeff() < 1e-13);
  }
}

TEST_CASE("logarithm of SE3 inverts the exponential to 1e-12 from 0 to pi") {
  std::mt19937 rng(2);
  for (double angle : {1e-300, 1e-15, 1e-9, 1e-6, 1e-4, 0.0014, 9e-3, 1.1e-2, 0.3, 1.0, 2.0, 3.0, 3.1, 3.14,
                       kPi - 1e-6, kPi - 1e-9}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Vector6 xi = random_twist(rng, angle);
      CHECK((se3_log(se3_exp(xi)) - xi).cwiseAbs().maxCoeff() < 1e-12 * (1.0 + 5.0 * xi.norm()));
    }
  }
  CHECK(se3_log(Pose::Identity()).norm() == 0.0);
}

TEST_CASE("the logarithm keeps the small rotations between two scans") {
  for (double degrees : {0.01, 0.05, 0.08, 0.0802, 0.1, 0.2}) {
    const double angle = degrees * kDegree;
    const Eigen::Vector3d phi =
        so3_log(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix());
    CHECK(phi.z() == doctest::Approx(angle).epsilon(1e-12));
  }
}

TEST_CASE("left Jacobian of SE3 equals numeric derivatives") {
  std::mt19937 rng(3);
  for (double angle : {1e-9, 1e-3, 0.3, 0.49, 0.51, 1.5, 3.0}) {
    const Vector6 xi = random_twist(rng, angle);
    const Matrix6 analytic = se3_left_jacobian(xi);
    const double h = 1e-6;
    for (int k = 0; k < 6; ++k) {
      Vector6 step = Vector6::Zero();
      step[k] = h;
      const Vector6 forward = se3_log(se3_exp(xi + step) * se3_exp(xi).inverse());
      const Vector6 backward = se3_log(se3_exp(xi - step) * se3_exp(xi).inverse());
      CHECK(((forward - backward) / (2 * h) - analytic.col(k)).cwiseAbs().maxCoeff() < 1e-8);
    }
  }
}

TEST_CASE("adjoint moves a twist through a pose") {
  std::mt19937 rng(4);
  const Pose pose = se3_exp(random_twist(rng, 1.2));
  const Vector6 xi = random_twist(rng, 0.7);
  const Pose expected = pose * se3_exp(xi) * pose.inverse();
  CHECK((se3_exp(adjoint(pose) * xi).matrix() - expected.matrix()).cwiseAbs().maxCoeff() < 1e-12);
}

}  // namespace scanlock
