// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/tracking_promise.hpp"

#include <cmath>

namespace scanlock {
namespace {

constexpr double kQuantile = 2.326;  // of a normal variable, one-sided: 99 %

}  // namespace

/// The squared length is treated as a gamma variable of its mean and variance (Satterthwaite); its quantile
/// is by the formula of Wilson and Hilferty.
double squared_bound(const Eigen::Matrix3d& covariance) {
  const double mean = covariance.trace(), spread = covariance.squaredNorm();
  if (!(mean > 0)) return mean;
  const double freedom = mean * mean / spread, ninth = 2.0 / (9.0 * freedom);
  const double root = 1.0 - ninth + kQuantile * std::sqrt(ninth);
  return mean * root * root * root;
}

std::uint32_t unknown_axes(const Matrix6& covariance, std::uint32_t seen, double metres, double radians) {
  std::uint32_t axes = 0;
  for (const int first : {0, 3}) {
    Eigen::Matrix3d part = covariance.block<3, 3>(first, first);
    for (int axis = 0; axis < 3; ++axis) {
      if ((seen >> (first + axis) & 1u) != 0) continue;
      part.row(axis).setZero();
      part.col(axis).setZero();
    }
    const double most = first == 0 ? metres : radians;
    if (squared_bound(part) < most * most) continue;
    int worst = 0;
    part.diagonal().maxCoeff(&worst);
    for (int axis = 0; axis < 3; ++axis) {
      const bool alone = squared_bound(Eigen::Vector3d(part(axis, axis), 0, 0).asDiagonal()) >= most * most;
      if (alone || axis == worst) axes |= 1u << (first + axis);
    }
  }
  return axes;
}

}  // namespace scanlock
