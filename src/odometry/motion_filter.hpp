// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "icp/scan_alignment.hpp"

namespace scanlock {

inline constexpr int kSwinging[] = {2, 3, 4};  ///< z, roll, pitch: what hands, legs and springs do

inline constexpr double kPoseFloor = 1e-3;  ///< metres and radians: no pose is known better than this

/// The motion between scans: body velocity, disturbed by white noise on the acceleration. Speed, drift and
/// turn rate go on; what hands, legs and springs do, along z and about x and y, comes back to its mean of the
/// last few seconds (an Ornstein-Uhlenbeck process), so that a direction that a scene hardly holds does not
/// coast. It gives each scan its prior over the *real* time since the last one, so that a gap in the data is
/// bridged and not skipped.
class MotionFilter {
 public:
  /// Accelerations that the robot may well reach, m/s^2 and rad/s^2; one that lasts `kManoeuvre` seconds is
  /// one sigma.
  MotionFilter(double acceleration, double angular_acceleration);

  /// At a pose, the velocity a guess that may be anything.
  void start(const MovingPose& guess);
  /// Whether it moves in its own plane of x and y, from now on: nothing else is measured then.
  void set_planar(bool planar);

  /// The state `dt` seconds on (dt >= 0): its mean is the prediction, its information what it is worth.
  MotionPrior predict(double dt) const;
  /// The same, where others say how the body moved (last_from_now), of which a planar one takes what is in
  /// its plane. It is worth no more: an odometry that slips must not weigh more than a velocity that changes.
  MotionPrior predict(double dt, const Pose& motion) const;

  /// Takes the outcome of an alignment that used `prior`: state and covariance become the posterior.
  /// `variance`: of one residual, m^2, correlations counted in.
  void update(const MotionPrior& prior, const ScanAlignment& alignment, double variance);

  /// Takes the prediction for the state: nothing was seen.
  void coast(const MotionPrior& prior);
  /// From now on it is predicted as standing; what the velocity may be is as uncertain as before.
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

/// Of a pose known to so much in all directions, and of a velocity with that covariance (its last six).
Matrix12 prior_information(double metres, double radians, const Matrix12& covariance);

/// How far a moving pose is from a prior: the squared Mahalanobis distance of its twelve numbers.
double squared_gap(const MotionPrior& prior, const MovingPose& moving);

/// The covariance of its pose, the velocity being whatever it may: metres and radians, in the body frame.
Matrix6 pose_covariance(const MotionPrior& prior);

/// The same prior, believed a hundredth as much: for another try where it did not explain the scan.
MotionPrior loosened(MotionPrior prior);

}  // namespace scanlock
