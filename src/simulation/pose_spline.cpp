// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/pose_spline.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

Eigen::Matrix3d rotation_of(const Vector6& q) {
  return yaw_pitch_roll(q[5], q[4], q[3]);
}

}  // namespace

PoseSpline::PoseSpline(double begin, double step, std::vector<Vector6> control)
    : begin_(begin), step_(step), control_(std::move(control)) {
  if (control_.size() < 4) throw std::invalid_argument("a cubic spline needs four control points");
}

Vector6 PoseSpline::evaluate(double t, int derivative) const {
  const double position = (t - begin_) / step_;
  const double last = static_cast<double>(control_.size() - 4);
  const double span = std::clamp(std::floor(position), 0.0, last);
  const double u = std::clamp(position - span, 0.0, 1.0), w = 1 - u;
  const Vector6* c = &control_[static_cast<std::size_t>(span)];
  if (derivative == 0)
    return (w * w * w * c[0] + (3 * u * u * u - 6 * u * u + 4) * c[1] +
            (-3 * u * u * u + 3 * u * u + 3 * u + 1) * c[2] + u * u * u * c[3]) /
           6;
  if (derivative == 1)
    return (-w * w * c[0] + (3 * u * u - 4 * u) * c[1] + (-3 * u * u + 2 * u + 1) * c[2] + u * u * c[3]) /
           (2 * step_);
  return (w * c[0] + (3 * u - 2) * c[1] + (1 - 3 * u) * c[2] + u * c[3]) / (step_ * step_);
}

Pose PoseSpline::pose(double t) const {
  const Vector6 q = evaluate(t, 0);
  Pose pose = Pose::Identity();
  pose.linear() = rotation_of(q);
  pose.translation() = q.head<3>();
  return pose;
}

Vector6 PoseSpline::twist(double t) const {
  const Vector6 q = evaluate(t, 0), rate = evaluate(t, 1);
  const auto [sin_roll, cos_roll] = sincos(q[3]);
  const auto [sin_pitch, cos_pitch] = sincos(q[4]);
  Vector6 twist;
  twist.head<3>() = rotation_of(q).transpose() * rate.head<3>();
  twist[3] = rate[3] - rate[5] * sin_pitch;
  twist[4] = rate[4] * cos_roll + rate[5] * cos_pitch * sin_roll;
  twist[5] = -rate[4] * sin_roll + rate[5] * cos_pitch * cos_roll;
  return twist;
}

Eigen::Vector3d PoseSpline::acceleration(double t) const {
  return evaluate(t, 2).head<3>();
}

}  // namespace scanlock
