// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "icp/scan_alignment.hpp"

namespace scanlock {

inline constexpr double kPoseFloor = 1e-3;  ///< metres and radians: least standard deviation of a pose

/// The motion between scans: body velocity, disturbed by white noise on the acceleration. Velocities along x
/// and y and about z (speed, drift, turn rate) are predicted to persist. Velocities along z and about x and
/// y, which hands, legs and springs cause, are predicted to return to their mean of the last few seconds (an
/// Ornstein-Uhlenbeck process), so that the estimate does not coast along a direction that the scene hardly
/// constrains. Each scan gets its prior over the *real* time since the last scan, so that a gap in the data
/// is bridged and not skipped.
class MotionFilter {
 public:
  /// Standard deviations of accelerations, m/s^2 and rad/s^2, each of which lasts kManoeuvre seconds.
  MotionFilter(double acceleration, double angular_acceleration);

  /// Starts at the pose of `guess`, with its velocity as the mean and a wide covariance of the velocity.
  void start(const MovingPose& guess);
  /// Whether the body moves in its own plane of x and y from now on: z, roll and pitch are then not
  /// estimated.
  void set_planar(bool planar);

  /// The predicted state, `dt` seconds on (dt >= 0): mean and information.
  MotionPrior predict(double dt) const;
  /// The same with the motion of auxiliary odometry (last_from_now) as the mean; a planar filter takes only
  /// the part of the motion in its plane. The information stays that of the prediction by velocity: odometry
  /// may slip, and must not weigh more than that prediction.
  MotionPrior predict(double dt, const Pose& motion) const;

  /// State and covariance become the posterior of an alignment that used `prior`. `variance`: of one
  /// residual, m^2, inflated for the correlation of residuals.
  void update(const MotionPrior& prior, const ScanAlignment& alignment, double variance);

  /// The prediction becomes the state, without a measurement.
  void coast(const MotionPrior& prior);
  /// The velocity becomes zero; its covariance stays.
  void stand();

  const MovingPose& state() const { return state_; }
  /// Covariance of [pose error; twist error], order and frame as in MotionPrior.
  const Matrix12& covariance() const { return covariance_; }

 private:
  void follow_mean(double seconds);

  static constexpr double kManoeuvre = 0.3;  // seconds
  /// kReturn: seconds in which the deviation of a velocity (along z, about x or y) from its mean decays to
  /// 1/e: steps and springs swing at 1 to 2 Hz. kMeanOver: seconds over which that mean is taken: longer than
  /// a step, shorter than a ramp or a climb.
  static constexpr double kReturn = 0.3, kMeanOver = 3.0;
  double linear_density_,
      angular_density_;  ///< power spectral densities of the white noise, m^2/s^3 and rad^2/s^3
  MovingPose state_;
  Vector6 mean_twist_ = Vector6::Zero();  ///< over the last kMeanOver seconds
  bool planar_ = false;
  Matrix12 covariance_ = Matrix12::Identity();
};

/// Information of a pose with these standard deviations along and about all axes, and of a velocity whose
/// covariance is the last six rows and columns of `covariance`, plus 0.01 on the diagonal.
Matrix12 prior_information(double metres, double radians, const Matrix12& covariance);

/// The squared Mahalanobis distance of pose and velocity from the mean of a prior (12 degrees of freedom).
double squared_gap(const MotionPrior& prior, const MovingPose& moving);

/// The covariance of the pose of a prior, with the velocity marginalised: metres and radians, in the body
/// frame.
Matrix6 pose_covariance(const MotionPrior& prior);

/// The same prior with a hundredth of its information: for a second alignment of a scan that the first
/// alignment did not explain.
MotionPrior loosened(MotionPrior prior);

}  // namespace scanlock
