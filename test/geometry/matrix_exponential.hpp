// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>

#include "geometry/rigid.hpp"

namespace scanlock {

/// The element of the Lie algebra se(3).
inline Eigen::MatrixXd as_matrix(const Vector6& xi) {
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(4, 4);
  m.topLeftCorner<3, 3>() = hat(xi.tail<3>());
  m.topRightCorner<3, 1>() = xi.head<3>();
  return m;
}

/// exp by its definition, equation 11: the Taylor series of a square matrix of any size, scaled and squared.
inline Eigen::MatrixXd matrix_exponential(Eigen::MatrixXd m) {
  int halvings = 0;
  for (; m.norm() > 0.25; ++halvings) m *= 0.5;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Identity(m.rows(), m.cols()), term = sum;
  for (int k = 1; k <= 16; ++k) {
    term = (term.lazyProduct(m) / k).eval();
    sum += term;
  }
  for (; halvings > 0; --halvings) sum = sum.lazyProduct(sum).eval();
  return sum;
}

}  // namespace scanlock
