// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/linear.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace scanlock {

Vector6 solve(const Matrix6& a, const Vector6& b) {
  return a.ldlt().solve(b);
}

Vector12 solve(const Matrix12& a, const Vector12& b) {
  return a.ldlt().solve(b);
}

Matrix12 inverse(const Matrix12& a) {
  return a.ldlt().solve(Matrix12::Identity());
}

Matrix6 inverse(const Matrix6& a) {
  return a.inverse();
}

}  // namespace scanlock
