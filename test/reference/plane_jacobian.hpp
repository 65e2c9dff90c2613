// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include "geometry/rigid.hpp"

namespace scanlock::reference {

struct PoseDerivatives {
  std::array<Eigen::Matrix3d, 3> rotation;  // dR / d delta_j
  Eigen::Matrix3d by_delta, by_u;           // dt / d delta, dt / d u
};

/// Appendix D of Fast and Robust Iterative Closest Point, of R = exp(delta^), t = ((R - I) u^ delta + delta
/// delta^T u) / |delta|^2. Two corrections of the print: in dt/d delta the last term is M delta delta^T, not
/// M delta^T delta; and at delta = 0, where dt/d delta_j is printed as 0, it is e_j^ u / 2.
inline PoseDerivatives appendix_d(const Eigen::Vector3d& delta, const Eigen::Vector3d& u) {
  PoseDerivatives d;
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  const double square = delta.squaredNorm();
  if (square == 0) {
    for (int j = 0; j < 3; ++j) {
      d.rotation[static_cast<std::size_t>(j)] = hat(identity.col(j));
      d.by_delta.col(j) = 0.5 * hat(identity.col(j)) * u;
    }
    d.by_u = identity;
    return d;
  }
  const Eigen::Matrix3d r = so3_exp(delta);
  Eigen::Matrix3d changes;
  for (int j = 0; j < 3; ++j) {
    const Eigen::Matrix3d dr =
        (delta[j] * hat(delta) + hat(delta.cross((identity - r) * identity.col(j)))) / square * r;
    d.rotation[static_cast<std::size_t>(j)] = dr;
    changes.col(j) = dr * hat(u) * delta;
  }
  const Eigen::Matrix3d m = (r - identity) * hat(u) + delta.dot(u) * identity;
  d.by_delta = (m + delta * u.transpose() + changes) / square -
               2.0 / (square * square) * m * delta * delta.transpose();
  d.by_u = ((identity - r) * hat(delta) + delta * delta.transpose()) / square;
  return d;
}

}  // namespace scanlock::reference
