// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/rigid.hpp"

namespace scanlock {

/// Weighted sums over pairs of points (p, q), metres: rigid_fit() computes from them the rigid motion that
/// moves p onto q.
struct PairSums {
  double weight = 0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), q = Eigen::Vector3d::Zero();
  Eigen::Matrix3d qp = Eigen::Matrix3d::Zero();  ///< sum w q p^T

  void add(double w, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    weight += w;
    p += w * from;
    q += w * to;
    qp += (w * to) * from.transpose();
  }
  void add(const PairSums& other) {
    weight += other.weight;
    p += other.p;
    q += other.q;
    qp += other.qp;
  }
};

/// argmin sum w |R p + t - q|^2 over rigid motions, equation 17, by the singular value decomposition. Where
/// the pairs do not determine the rotation (all on a line, or all in one point), the minimum with the
/// smallest rotation. The identity when the sum of weights is 0.
Pose rigid_fit(const PairSums& sums);

}  // namespace scanlock
