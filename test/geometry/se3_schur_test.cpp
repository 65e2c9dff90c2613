// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of the closed form of the logarithm against that of SE(d) by the real Schur form (appendix A,
// algorithm 3).
#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "geometry/angles.hpp"
#include "geometry/rigid.hpp"
#include "matrix_exponential.hpp"

namespace {

using namespace scanlock;

/// Appendix A. Equation 32 is printed with B_i; it holds for the generator B_i / theta_i.
SmallMatrix schur_log(const SmallMatrix& t) {
  const Eigen::Index n = t.rows() - 1;
  const Eigen::RealSchur<SmallMatrix> schur(t.topLeftCorner(n, n));
  const SmallMatrix q = schur.matrixU(), d = schur.matrixT();
  SmallMatrix b = SmallMatrix::Zero(n, n), v = SmallMatrix::Identity(n, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    if (d(i + 1, i) == 0) continue;
    const double theta = std::atan2(d(i + 1, i), d(i, i));
    SmallMatrix generator = SmallMatrix::Zero(n, n);
    generator(i, i + 1) = -1;
    generator(i + 1, i) = 1;
    b += theta * generator;
    v += -0.5 * theta * generator +
         (1.0 - 0.5 * theta * std::sin(theta) / (1.0 - std::cos(theta))) * generator * generator;
    ++i;
  }
  SmallMatrix result = SmallMatrix::Zero(n + 1, n + 1);
  result.topLeftCorner(n, n) = q * b * q.transpose();
  result.topRightCorner(n, 1) = q * v * q.transpose() * t.topRightCorner(n, 1);
  return result;
}

}  // namespace

TEST_CASE("the logarithm by the Schur form inverts the exponential in two to six dimensions") {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int n = 2; n <= 6; ++n) {
    for (int trial = 0; trial < 20; ++trial) {
      SmallMatrix s = SmallMatrix::NullaryExpr(n, n, [&] { return normal(random); });
      s = (s - s.transpose()).eval();
      s *= 2.5 / s.norm();
      SmallMatrix xi = SmallMatrix::Zero(n + 1, n + 1);
      xi.topLeftCorner(n, n) = s;
      xi.topRightCorner(n, 1) = SmallMatrix::NullaryExpr(n, 1, [&] { return normal(random); });
      CHECK((schur_log(matrix_exponential(xi)) - xi).norm() < 1e-10);
    }
  }
}

TEST_CASE("the closed form agrees with the Schur form from the smallest angles to pi") {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (const double angle : {1e-3, 0.01, 0.1, 1.0, 2.0, 3.0, 3.1, kPi - 1e-3, kPi - 1e-5}) {
    for (int trial = 0; trial < 50; ++trial) {
      const Eigen::Vector3d axis =
          Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
      Pose pose = Pose::Identity();
      pose.linear() = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
      pose.translation() = Eigen::Vector3d(normal(random), normal(random), normal(random));
      const Vector6 xi = se3_log(pose);
      CHECK(std::abs(xi.tail<3>().norm() - angle) < 1e-12);
      // The reference itself divides by 1 - cos(angle), and the Schur iteration loses a digit or two.
      const double slack = 1e-12 + 1e-15 / (angle * angle);
      CHECK((schur_log(pose.matrix()) - as_matrix(xi)).norm() < slack);
    }
  }
}

TEST_CASE("small rotations are not lost") {
  for (const double degrees : {1e-7, 1e-4, 0.01, 0.05, 0.08}) {
    Vector6 xi;
    xi << 1, -2, 0.5, 0, 0, degrees * kDegree;
    CHECK((se3_log(se3_exp(xi)) - xi).norm() < 1e-14);
  }
}
