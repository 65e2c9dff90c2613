// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/rigid.hpp"
#include "geometry/symmetric_eigen.hpp"

namespace scanlock {

using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;
using Vector18 = Eigen::Matrix<double, 18, 1>;
using Matrix18 = Eigen::Matrix<double, 18, 18>;

// Linear systems for poses and motions, compiled once, in linear.cpp: the unrolled code takes long to
// compile.

/// The solution of a x = b for a positive definite a (LDLT).
Vector6 solve(const Matrix6& a, const Vector6& b);
Vector12 solve(const Matrix12& a, const Vector12& b);
Vector18 solve(const Matrix18& a, const Vector18& b);
/// The inverse of a positive definite matrix (LDLT).
Matrix12 inverse(const Matrix12& a);
/// The inverse of any invertible matrix (LU).
Matrix6 inverse(const Matrix6& a);
/// The lower triangular l with l l^T = a, for a positive definite a.
Matrix6 cholesky(const Matrix6& a);
/// By Eigen's iteration. If it does not converge, the values are NaN and the vectors the identity.
SymmetricEigen<6> symmetric_eigen(const Matrix6& a);

}  // namespace scanlock
