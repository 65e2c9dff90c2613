// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>

namespace scanlock {

/// Eigenvalues of a symmetric matrix, ascending, and its unit eigenvectors in the columns, in the same order.
template <int kAxes>
struct SymmetricEigen {
  Eigen::Matrix<double, kAxes, 1> values;
  Eigen::Matrix<double, kAxes, kAxes> vectors;
};

/// Closed form, from the lower triangle of `a`. For eigenvalues at any distance from each other, values are
/// accurate to 4e-15 of the largest element, |A v - l v| is below 2e-15 of it, and the vectors are
/// orthonormal to 1e-15. For a matrix that is not finite, values are NaN and vectors the identity. Used in
/// place of Eigen's computeDirect, which computes a third of an arc cosine by functions of the C library,
/// whose bits differ between machines, and separates nearly equal eigenvalues with an error of 1e-8.
SymmetricEigen<2> symmetric_eigen(const Eigen::Matrix2d& a);
SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix3d& a);

}  // namespace scanlock
