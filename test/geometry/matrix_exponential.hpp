// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>

#include "geometry/rigid.hpp"

namespace scanlock {

/// A matrix of at most seven rows, which compiles in a third of the time.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 7, 7>;

/// The element of the Lie algebra se(3).
inline SmallMatrix as_matrix(const Vector6& xi) {
  SmallMatrix m = SmallMatrix::Zero(4, 4);
  m.topLeftCorner<3, 3>() = hat(xi.tail<3>());
  m.topRightCorner<3, 1>() = xi.head<3>();
  return m;
}

/// exp by its definition, equation 11: the Taylor series of a square matrix, with scaling and squaring.
inline SmallMatrix matrix_exponential(SmallMatrix m) {
  int halvings = 0;
  for (; m.norm() > 0.25; ++halvings) m *= 0.5;
  SmallMatrix sum = SmallMatrix::Identity(m.rows(), m.cols()), term = sum;
  for (int k = 1; k <= 16; ++k) {
    term = (term.lazyProduct(m) / k).eval();
    sum += term;
  }
  for (; halvings > 0; --halvings) sum = sum.lazyProduct(sum).eval();
  return sum;
}

}  // namespace scanlock
