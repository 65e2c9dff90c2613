// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/linear.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <limits>

namespace scanlock {
namespace {

/// Matrices of 6, 12 or 18 rows share one instantiation of each decomposition, which takes seconds to
/// compile. On the stack.
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 18, 18>;
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 18, 1>;

Column solve(const Square& a, const Column& b) {
  return a.ldlt().solve(b);
}

}  // namespace

Vector6 solve(const Matrix6& a, const Vector6& b) {
  return solve(Square(a), Column(b));
}

Vector12 solve(const Matrix12& a, const Vector12& b) {
  return solve(Square(a), Column(b));
}

Vector18 solve(const Matrix18& a, const Vector18& b) {
  return solve(Square(a), Column(b));
}

// Solved column by column: for several columns at once, Eigen's order of additions depends on the registers
// of the processor.

Matrix12 inverse(const Matrix12& a) {
  const Eigen::LDLT<Square> factors(a);
  Matrix12 inverse;
  for (int i = 0; i < 12; ++i) inverse.col(i) = factors.solve(Column(Vector12::Unit(i)));
  return inverse;
}

Matrix6 inverse(const Matrix6& a) {
  const Eigen::PartialPivLU<Square> factors(a);
  Matrix6 inverse;
  for (int i = 0; i < 6; ++i) inverse.col(i) = factors.solve(Column(Vector6::Unit(i)));
  return inverse;
}

Matrix6 cholesky(const Matrix6& a) {
  return Square(a).llt().matrixL();
}

SymmetricEigen<6> symmetric_eigen(const Matrix6& a) {
  const Eigen::SelfAdjointEigenSolver<Square> solver(a);
  if (solver.info() == Eigen::Success) return {solver.eigenvalues(), solver.eigenvectors()};
  return {Vector6::Constant(std::numeric_limits<double>::quiet_NaN()), Matrix6::Identity()};
}

}  // namespace scanlock
