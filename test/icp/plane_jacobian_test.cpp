// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tests of appendix D of the paper, with its errors corrected in test/reference: the derivatives of the
// point-to-plane residual by the element of se(3) against numeric ones, element by element.
#include "../reference/plane_jacobian.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "cloud_samples.hpp"
#include "geometry/linear.hpp"
#include "icp/cloud_problem.hpp"

using namespace scanlock;
using namespace scanlock::test;
using reference::appendix_d;
using reference::PoseDerivatives;

namespace {

Pose pose_at(const Eigen::Vector3d& delta, const Eigen::Vector3d& u) {
  Vector6 xi;
  xi << u, delta;
  return se3_exp(xi);
}

}  // namespace

TEST_CASE("the derivatives of appendix D agree with numeric ones in every element") {
  Random random(1);
  for (const double size : {0.0, 1e-3, 0.1, 1.0, 2.5, 3.1}) {
    const Eigen::Vector3d delta = size * random.vector().normalized(), u = 2.0 * random.vector();
    const PoseDerivatives d = appendix_d(delta, u);
    const double h = 1e-6, tolerance = size > 0 && size < 0.01 ? 1e-5 : 1e-8;
    CAPTURE(size);
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(j);
      const Pose after = pose_at(delta + e, u), before = pose_at(delta - e, u);
      const Eigen::Matrix3d dr = (after.linear() - before.linear()) / (2 * h);
      const Eigen::Vector3d dt = (after.translation() - before.translation()) / (2 * h);
      const Eigen::Vector3d du =
          (pose_at(delta, u + e).translation() - pose_at(delta, u - e).translation()) / (2 * h);
      for (int row = 0; row < 3; ++row) {
        CAPTURE(row);
        CAPTURE(j);
        CHECK(std::abs(d.by_delta(row, j) - dt[row]) < tolerance);
        CHECK(std::abs(d.by_u(row, j) - du[row]) < tolerance);
        for (int column = 0; column < 3; ++column)
          CHECK(std::abs(d.rotation[static_cast<std::size_t>(j)](row, column) - dr(row, column)) < tolerance);
      }
    }
  }
}

TEST_CASE("the step's own derivative [n; p x n] is that of appendix D at delta = 0, about the moved point") {
  Random random(2);
  const PoseDerivatives d = appendix_d(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector3d p = 3.0 * random.vector(), n = random.vector().normalized();
    const Eigen::Vector3d lever = p.cross(n);
    for (int j = 0; j < 3; ++j) {
      CHECK(n.dot(d.by_u.col(j)) == doctest::Approx(n[j]));
      CHECK(n.dot(d.rotation[static_cast<std::size_t>(j)] * p) == doctest::Approx(lever[j]));
    }
  }
}

TEST_CASE("the plane step solves the normal equations of numeric derivatives") {
  // With fixed pairs and weights the step is the Gauss-Newton step of their residuals.
  Random random(3);
  const PointCloud cloud = room(random, 2000, 0.01);
  CloudTarget target(cloud);
  target.prepare_normals();
  const PointCloud other = moved(room(random, 2000, 0.01), motion(-target.centre(), {0, 0, 0}));
  CloudProblem problem(other, target, {IcpObjective::kPlane, MotionCoordinates::kLieAlgebra, true, 1});
  const Pose start = motion({0.02, 0.01, 0}, {0, 0.003, 0.004});
  const StateVector x = problem.begin(start, 0.05, 0.5);
  problem.evaluate(x);
  Matrix6 hessian = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  const double h = 1e-6;
  for (std::size_t i = 0; i < other.size(); ++i) {
    const CloudProblem::Pair pair = problem.pair(i);
    if (!(pair.weight > 0)) continue;
    const Eigen::Vector3d n = pair.normal.cast<double>(),
                          q = target.points().point(static_cast<std::size_t>(pair.target)).cast<double>();
    const auto residual = [&](const Vector6& xi) {
      return n.dot(se3_exp(xi) * (start * other.point(i).cast<double>()) - q);
    };
    Vector6 j;
    for (int k = 0; k < 6; ++k)
      j[k] = (residual(h * Vector6::Unit(k)) - residual(-h * Vector6::Unit(k))) / (2 * h);
    hessian += pair.weight * j * j.transpose();
    gradient += pair.weight * residual(Vector6::Zero()) * j;
  }
  const Vector6 expected = -solve(hessian, gradient);
  const Vector6 step = problem.image() - x;
  CHECK((step - expected).norm() < 1e-4 * expected.norm());
}
