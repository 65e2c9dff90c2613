// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/linear.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <limits>

namespace scanlock {

Vector6 solve(const Matrix6& a, const Vector6& b) {
  return a.ldlt().solve(b);
}

Vector12 solve(const Matrix12& a, const Vector12& b) {
  return a.ldlt().solve(b);
}

Vector18 solve(const Matrix18& a, const Vector18& b) {
  return a.ldlt().solve(b);
}

Matrix12 inverse(const Matrix12& a) {
  return a.ldlt().solve(Matrix12::Identity());
}

Matrix6 inverse(const Matrix6& a) {
  return a.inverse();
}

Matrix6 cholesky(const Matrix6& a) {
  return a.llt().matrixL();
}

SymmetricEigen<6> symmetric_eigen(const Matrix6& a) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(a);
  if (solver.info() == Eigen::Success) return {solver.eigenvalues(), solver.eigenvectors()};
  return {Vector6::Constant(std::numeric_limits<double>::quiet_NaN()), Matrix6::Identity()};
}

}  // namespace scanlock
