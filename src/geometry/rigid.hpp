// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace scanlock {

/// A rigid transform; `Pose a_from_b` maps coordinates in b to coordinates in a.
using Pose = Eigen::Isometry3d;

/// An element of se(3) as a vector: [u; phi], translation part first (metres), then rotation (radians).
/// A body velocity has the same layout (m/s, rad/s). Six-by-six matrices use the same order.
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// The matrix a^ with a^ b = a x b.
Eigen::Matrix3d hat(const Eigen::Vector3d& a);

/// The rotation by an angle (radians) about the z axis, and Rz(yaw) Ry(pitch) Rx(roll). Used in place of
/// Eigen's AngleAxis, which calls the sine and cosine of the C library.
Eigen::Matrix3d rotation_about_z(double angle);
Eigen::Matrix3d yaw_pitch_roll(double yaw, double pitch, double roll);

/// Exponential and logarithm of SO(3). exp is accurate to rounding for every argument; log returns the
/// rotation vector of length in [0, pi], accurate to rounding from 0 to pi (tests compare it with appendix A
/// of Zhang et al.; the authors' code returns 0 below 0.081 degrees, a usual rotation between two scans).
Eigen::Matrix3d so3_exp(const Eigen::Vector3d& phi);
Eigen::Vector3d so3_log(const Eigen::Matrix3d& rotation);

/// Exponential and logarithm of SE(3) (equations 10 and 11), closed form.
Pose se3_exp(const Vector6& xi);
Vector6 se3_log(const Pose& pose);

/// Left Jacobian of SO(3) and of SE(3): exp(xi + d) = exp(J_l(xi) d) exp(xi) to first order in d.
Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& phi);
Matrix6 se3_left_jacobian(const Vector6& xi);

/// Adjoint: T exp(xi) T^-1 = exp(Ad(T) xi).
Matrix6 adjoint(const Pose& pose);

/// The smallest rotation that turns the direction of `from` into that of `to` (vectors of any length but 0);
/// for opposite directions, half a turn about some perpendicular axis.
Eigen::Quaterniond least_rotation(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// The smallest rotation that turns `up` (any length but 0) into the z axis; for the direction opposite to z,
/// half a turn about some horizontal axis.
Eigen::Matrix3d level_rotation(const Eigen::Vector3d& up);

/// The pose with its rotation made orthonormal again (by a unit quaternion), for products of many poses. A
/// rotation that is orthonormal already changes by rounding only.
Pose renormalised(const Pose& pose);

/// The pose with the same position and heading and without roll and pitch, for a frame whose z axis is up.
/// The heading is that of the x axis; 0 where the x axis is vertical.
Pose upright(const Pose& pose);

/// True if the translation of a^-1 b is shorter than `metres` and its rotation angle is below `radians`.
bool near(const Pose& a, const Pose& b, double metres, double radians);

}  // namespace scanlock
