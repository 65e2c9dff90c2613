// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/rigid.hpp"

namespace scanlock {

/// Weighted sums over pairs of points (p, q), from which the rigid motion that brings p onto q follows in
/// closed form.
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

/// argmin sum w |R p + t - q|^2 over rigid motions, equation 17, by the singular value decomposition. What
/// the pairs leave open (all on a line, all in one point) stays as it is: of all minima the one nearest to no
/// rotation. No weight: identity.
Pose rigid_fit(const PairSums& sums);

}  // namespace scanlock
