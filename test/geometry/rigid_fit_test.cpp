// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/rigid_fit.hpp"

#include <doctest/doctest.h>

#include <random>
#include <vector>

using namespace scanlock;

namespace {

struct Random {
  std::mt19937 engine{11};
  std::normal_distribution<double> normal;
  Eigen::Vector3d vector() { return {normal(engine), normal(engine), normal(engine)}; }
  Pose pose() {
    Vector6 xi;
    xi << vector(), vector();
    return se3_exp(xi);
  }
};

}  // namespace

TEST_CASE("rigid_fit finds the motion of exact pairs whatever their weights") {
  Random random;
  for (int trial = 0; trial < 50; ++trial) {
    const Pose truth = random.pose();
    PairSums sums;
    for (int i = 0; i < 5; ++i) {
      const Eigen::Vector3d p = random.vector();
      sums.add(0.1 + i, p, truth * p);
    }
    CHECK((rigid_fit(sums).matrix() - truth.matrix()).norm() < 1e-9);
  }
}

TEST_CASE("rigid_fit is a minimum of the weighted squares") {
  Random random;
  std::vector<Eigen::Vector3d> p, q;
  std::vector<double> w;
  PairSums sums;
  for (int i = 0; i < 20; ++i) {
    p.push_back(random.vector());
    q.push_back(p.back() + 0.3 * random.vector());
    w.push_back(1.0 / (1 + i));
    sums.add(w.back(), p.back(), q.back());
  }
  const auto energy = [&](const Pose& pose) {
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) sum += w[i] * (pose * p[i] - q[i]).squaredNorm();
    return sum;
  };
  const Pose best = rigid_fit(sums);
  for (int trial = 0; trial < 200; ++trial) {
    Vector6 step;
    step << random.vector(), random.vector();
    CHECK(energy(se3_exp(1e-3 * step) * best) > energy(best));
  }
}

TEST_CASE("rigid_fit never mirrors and leaves unconstrained directions unchanged") {
  PairSums mirrored, one_point, line, none;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d e = Eigen::Vector3d::Unit(i) * (1.0 + i);
    mirrored.add(1, e, -e);
    mirrored.add(1, -e, e);
    one_point.add(1, {1, 2, 3}, {2, 2, 3});
    line.add(1, {1.0 * i, 0, 0}, {1.0 * i + 1, 0, 0});
  }
  CHECK(rigid_fit(mirrored).linear().determinant() == doctest::Approx(1));
  CHECK((rigid_fit(one_point).linear() - Eigen::Matrix3d::Identity()).norm() < 1e-9);
  CHECK((rigid_fit(one_point).translation() - Eigen::Vector3d(1, 0, 0)).norm() < 1e-9);
  CHECK((rigid_fit(line) * Eigen::Vector3d(0, 1, 1) - Eigen::Vector3d(1, 1, 1)).norm() < 1e-6);
  CHECK(rigid_fit(none).matrix() == Eigen::Matrix4d::Identity());
}
