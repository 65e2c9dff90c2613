// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <random>

namespace scanlock {

/// A random orthogonal matrix: the product of as many reflections as it has rows. Not the Q of a QR
/// decomposition, which takes long to compile.
template <typename Square>
Square random_reflections(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Square q = Square::Identity();
  for (int k = 0; k < Square::RowsAtCompileTime; ++k) {
    Eigen::Matrix<double, Square::RowsAtCompileTime, 1> v;
    for (double& x : v) x = normal(random);
    v.normalize();
    q -= 2.0 * (q * v).eval() * v.transpose();
  }
  return q;
}

}  // namespace scanlock
