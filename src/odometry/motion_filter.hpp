// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "icp/scan_alignment.hpp"

namespace scanlock {

inline constexpr double kPoseFloor = 1e-3;  ///< metres and radians: no pose is known better than this

/// The motion between scans: body velocity, disturbed by white noise on the acceleration. Speed, drift and
/// turn rate go on; what hands, legs and springs do, along z and about x and y, comes back to its mean of the
/// last few seconds (an Ornstein-Uhlenbeck process), so that a direction that a scene hardly holds does not
/// coast. It gives each scan its prior over the *real* time since the last one, so that a gap in the data is
/// bridged and not skipped.
class MotionFilter {
 public:
  /// Standard deviations of the acceleration, m/s^2 and rad/s^2, if each lasts kManoeuvre seconds.
  MotionFilter(double acceleration, double angular_acceleration);

  /// At the pose of `guess`, with its velocity as the mean and a wide covariance.
  void start(const MovingPose& guess);
  /// Whether it moves in its own plane of x and y from now on: z, roll and pitch are then not estimated.
  void set_planar(bool planar);

  /// The predicted state, `dt` seconds on (dt >= 0): mean and information.
  MotionPrior predict(double dt) const;
  /// The same with the motion of auxiliary odometry (last_from_now) as the mean; a planar filter takes its
  /// part in the plane. The information is no larger: an odometry that slips must not weigh more than a
  /// velocity that changes.
  MotionPrior predict(double dt, const Pose& motion) const;

  /// Takes the outcome of an alignment that used `prior`: state and covariance become the posterior.
  /// `variance`: of one residual, m^2, correlations counted in.
  void update(const MotionPrior& prior, const ScanAlignment& alignment, double variance);

  /// The prediction becomes the state, without a measurement.
  void coast(const MotionPrior& prior);
  /// The velocity becomes zero, with the covariance that it has.
  void stand();

  const MovingPose& state() const { return state_; }
  /// Of [pose error; twist error] as in MotionPrior.
  const Matrix12& covariance() const { return covariance_; }

 private:
  void follow_mean(double seconds);

  static constexpr double kManoeuvre = 0.3;  // seconds
  /// Seconds in which a velocity along z, about x or y is back at its mean but for 1/e: steps and springs
  /// swing at 1 to 2 Hz. And those over which the mean is taken: longer than a step, shorter than a ramp or a
  /// climb.
  static constexpr double kReturn = 0.3, kMeanOver = 3.0;
  double linear_density_,
      angular_density_;  ///< power spectral densities of the white noise, m^2/s^3 and rad^2/s^3
  MovingPose state_;
  Vector6 mean_twist_ = Vector6::Zero();  ///< over the last kMeanOver seconds
  bool planar_ = false;
  Matrix12 covariance_ = Matrix12::Identity();
};

/// Information of a pose with these standard deviations along and about all axes, and of a velocity with the
/// last six rows and columns of `covariance`.
Matrix12 prior_information(double metres, double radians, const Matrix12& covariance);

/// The squared Mahalanobis distance of pose and velocity from a prior (12 degrees of freedom).
double squared_gap(const MotionPrior& prior, const MovingPose& moving);

/// The covariance of its pose, with the velocity marginalised: metres and radians, in the body frame.
Matrix6 pose_covariance(const MotionPrior& prior);

/// The same prior with a hundredth of its information: for a second alignment where the first did not explain
/// the scan.
MotionPrior loosened(MotionPrior prior);

}  // namespace scanlock
