// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "geometry/rigid.hpp"

namespace scanlock {

/// A motion as a uniform cubic B-spline over x, y, z, roll, pitch, yaw (world from body = T(x, y, z) Rz Ry
/// Rx): position and attitude have continuous velocity and acceleration, all in closed form.
class PoseSpline {
 public:
  PoseSpline() = default;
  /// Control point i belongs to time begin + (i - 1) step; the spline is defined from `begin` to end(), in
  /// seconds.
  PoseSpline(double begin, double step, std::vector<Vector6> control);

  double begin() const { return begin_; }
  double end() const { return begin_ + step_ * static_cast<double>(control_.size() - 3); }

  Pose pose(double t) const;
  /// Velocity of the body in its own frame: [m/s; rad/s].
  Vector6 twist(double t) const;
  /// Acceleration of the body's origin in the world frame, m/s^2, without gravity.
  Eigen::Vector3d acceleration(double t) const;

 private:
  Vector6 evaluate(double t, int derivative) const;

  double begin_ = 0, step_ = 1;
  std::vector<Vector6> control_;
};

}  // namespace scanlock
