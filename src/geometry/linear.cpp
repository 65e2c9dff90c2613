// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/linear.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <limits>

namespace scanlock {
namespace {

/// Column by column: for several at once, Eigen adds in an order that depends on the processor's registers.
template <int kSize, typename Factors>
Eigen::Matrix<double, kSize, kSize> columns_of_inverse(const Factors& factors) {
  Eigen::Matrix<double, kSize, kSize> inverse;
  for (int i = 0; i < kSize; ++i)
    inverse.col(i) = factors.solve(Eigen::Matrix<double, kSize, 1>::Unit(i).eval());
  return inverse;
}

}  // namespace

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
  return columns_of_inverse<12>(a.ldlt());
}

Matrix6 inverse(const Matrix6& a) {
  return columns_of_inverse<6>(a.partialPivLu());
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
