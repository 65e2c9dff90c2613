// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>

namespace scanlock {

/// Of a symmetric matrix: eigenvalues, ascending, and unit eigenvectors in the columns, in the same order.
template <int kAxes>
struct SymmetricEigen {
  Eigen::Matrix<double, kAxes, 1> values;
  Eigen::Matrix<double, kAxes, kAxes> vectors;
};

/// Closed form, of the lower triangle. However close eigenvalues are, they are right to 4e-15 of the largest
/// element, A v - l v is 0 to 2e-15 of it, and the vectors are orthonormal to 1e-15. Not finite: values NaN,
/// axes those of the frame. In place of Eigen's computeDirect: that one takes a third of an arc cosine by the
/// functions of the C library, whose bits differ between machines, and splits nearly equal eigenvalues with
/// an error of 1e-8.
SymmetricEigen<2> symmetric_eigen(const Eigen::Matrix2d& a);
SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix3d& a);

}  // namespace scanlock
