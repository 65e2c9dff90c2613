// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/rigid.hpp"

#include <cmath>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

// The coefficients below lose digits by cancellation for small angles: below kSeriesAngle (radians) they are
// computed by Taylor series, whose first dropped term at kSeriesAngle is below 1e-16 of the sum.
constexpr double kSeriesAngle = 0.5;

/// sin(t)/t
double sinc(double t) {
  return std::abs(t) < 1e-8 ? 1.0 : sin(t) / t;
}

/// (1 - cos t) / t^2, without cancellation at any angle
double one_minus_cos_over_square(double t) {
  const double s = sinc(0.5 * t);
  return 0.5 * s * s;
}

/// sum_k (-1)^k t^(2k) / (2k + first)!, the tail of a sine or cosine series divided by its first power
double factorial_series(double t, int first) {
  double factorial = 1.0;
  for (int i = 2; i <= first; ++i) factorial *= i;
  double term = 1.0 / factorial;
  double sum = term;
  for (int k = 1; k <= 9; ++k) {
    term *= -t * t / ((first + 2 * k - 1) * (first + 2 * k));
    sum += term;
  }
  return sum;
}

/// (t - sin t) / t^3
double t_minus_sin_over_cube(double t) {
  return t < kSeriesAngle ? factorial_series(t, 3) : (t - sin(t)) / (t * t * t);
}

/// (cos t - 1 + t^2/2) / t^4
double cos_tail_over_fourth(double t) {
  return t < kSeriesAngle ? factorial_series(t, 4) : (cos(t) - 1.0 + 0.5 * t * t) / (t * t * t * t);
}

/// (sin t - t + t^3/6) / t^5
double sin_tail_over_fifth(double t) {
  return t < kSeriesAngle ? factorial_series(t, 5) : (sin(t) - t + t * t * t / 6.0) / (t * t * t * t * t);
}

/// (1 - (t/2) cot(t/2)) / t^2
double inverse_jacobian_coefficient(double t) {
  if (t < 1e-2) return 1.0 / 12.0 + t * t / 720.0 + t * t * t * t / 30240.0;
  const double half = 0.5 * t;
  const SineCosine s = sincos(half);
  return (1.0 - half * s.cosine / s.sine) / (t * t);
}

}  // namespace

Eigen::Matrix3d hat(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

Eigen::Matrix3d rotation_about_z(double angle) {
  const auto [s, c] = sincos(angle);
  Eigen::Matrix3d rotation;
  rotation << c, -s, 0, s, c, 0, 0, 0, 1;
  return rotation;
}

Eigen::Matrix3d yaw_pitch_roll(double yaw, double pitch, double roll) {
  const auto [sy, cy] = sincos(yaw);
  const auto [sp, cp] = sincos(pitch);
  const auto [sr, cr] = sincos(roll);
  Eigen::Matrix3d rotation;
  rotation << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,          //
      -sp, cp * sr, cp * cr;
  return rotation;
}

Eigen::Matrix3d so3_exp(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d h = hat(phi);
  return Eigen::Matrix3d::Identity() + sinc(angle) * h + one_minus_cos_over_square(angle) * h * h;
}

Eigen::Vector3d so3_log(const Eigen::Matrix3d& rotation) {
  // By way of the quaternion, whose largest component is at least 1/2, so that no angle in [0, pi] loses
  // digits.
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < 1e-150) return 2.0 * q.vec();
  return (2.0 * atan2(sine, q.w()) / sine) * q.vec();
}

Pose se3_exp(const Vector6& xi) {
  const Eigen::Vector3d phi = xi.tail<3>();
  Pose pose = Pose::Identity();
  pose.linear() = so3_exp(phi);
  pose.translation() = so3_left_jacobian(phi) * xi.head<3>();
  return pose;
}

Vector6 se3_log(const Pose& pose) {
  const Eigen::Vector3d phi = so3_log(pose.linear());
  const Eigen::Vector3d t = pose.translation();
  const Eigen::Vector3d phi_t = phi.cross(t);
  Vector6 xi;
  xi.head<3>() = t - 0.5 * phi_t + inverse_jacobian_coefficient(phi.norm()) * phi.cross(phi_t);
  xi.tail<3>() = phi;
  return xi;
}

Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d h = hat(phi);
  return Eigen::Matrix3d::Identity() + one_minus_cos_over_square(angle) * h +
         t_minus_sin_over_cube(angle) * h * h;
}

Matrix6 se3_left_jacobian(const Vector6& xi) {
  // Barfoot, State Estimation for Robotics, equation 7.86.
  const Eigen::Matrix3d u = hat(xi.head<3>());
  const Eigen::Matrix3d p = hat(xi.tail<3>());
  const double t = xi.tail<3>().norm();
  const double a = t_minus_sin_over_cube(t);
  const double b = cos_tail_over_fourth(t);
  const double c = 0.5 * (b - 3.0 * sin_tail_over_fifth(t));
  const Eigen::Matrix3d pup = p * u * p;
  const Eigen::Matrix3d q =
      0.5 * u + a * (p * u + u * p + pup) + b * (p * p * u + u * p * p - 3.0 * pup) + c * (pup * p + p * pup);
  Matrix6 jacobian = Matrix6::Zero();
  jacobian.topLeftCorner<3, 3>() = jacobian.bottomRightCorner<3, 3>() = so3_left_jacobian(xi.tail<3>());
  jacobian.topRightCorner<3, 3>() = q;
  return jacobian;
}

Matrix6 adjoint(const Pose& pose) {
  Matrix6 ad = Matrix6::Zero();
  ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = pose.linear();
  ad.topRightCorner<3, 3>() = hat(pose.translation()) * pose.linear();
  return ad;
}

Eigen::Quaterniond least_rotation(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized(), b = to.normalized();
  const Eigen::Vector3d across = a.cross(b);
  const double cosine = a.dot(b);
  // For nearly opposite directions the sum 1 + cosine loses digits; the squared sine keeps them.
  const double one_plus = cosine < 0 ? across.squaredNorm() / (1.0 - cosine) : 1.0 + cosine;
  Eigen::Quaterniond q;
  if (one_plus < 1e-12) {
    q.w() = 0;
    q.vec() = a.unitOrthogonal();
  } else {
    const double twice = std::sqrt(2.0 * one_plus);  // the cosine of half the angle
    q.w() = 0.5 * twice;
    q.vec() = across * (1.0 / twice);
  }
  return q;
}

Eigen::Matrix3d level_rotation(const Eigen::Vector3d& up) {
  return least_rotation(up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

Pose renormalised(const Pose& pose) {
  Pose result = pose;
  result.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
  return result;
}

Pose upright(const Pose& pose) {
  Pose result = Pose::Identity();
  result.translation() = pose.translation();
  const Eigen::Vector2d ahead = pose.linear().col(0).head<2>();
  const double length = ahead.norm();
  if (!(length > 1e-6)) return result;
  const Eigen::Vector2d x = ahead / length;
  result.linear().topLeftCorner<2, 2>() << x.x(), -x.y(), x.y(), x.x();
  return result;
}

bool near(const Pose& a, const Pose& b, double metres, double radians) {
  const Pose difference = a.inverse() * b;
  return difference.translation().norm() < metres && so3_log(difference.linear()).norm() < radians;
}

}  // namespace scanlock
