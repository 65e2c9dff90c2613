// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/rigid_fit.hpp"

#include <Eigen/SVD>

namespace scanlock {
namespace {

// Weight of the identity, which selects the smallest rotation where the pairs leave it open; the bias on a
// rotation that the pairs determine is below 1e-11 rad.
constexpr double kTieBreak = 1e-12;

}  // namespace

Pose rigid_fit(const PairSums& sums) {
  Pose pose = Pose::Identity();
  if (!(sums.weight > 0)) return pose;
  const Eigen::Vector3d mean_p = sums.p / sums.weight, mean_q = sums.q / sums.weight;
  Eigen::Matrix3d cross = sums.qp / sums.weight - mean_q * mean_p.transpose();
  cross += Eigen::Matrix3d::Identity() * (kTieBreak * cross.norm());
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if (u.determinant() * svd.matrixV().determinant() < 0) u.col(2) = -u.col(2);
  if (cross.norm() > 0) pose.linear() = u * svd.matrixV().transpose();
  pose.translation() = mean_q - pose.linear() * mean_p;
  return pose;
}

}  // namespace scanlock
