// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include "icp/scan_alignment.hpp"

namespace scanlock {

/// The covariance of the estimate of a motion filter, from the scans and not from the filter's own
/// assumptions. An alignment with a prior ends where the gradient of both is zero; to first order its error
/// is
///   e = G e_predicted + L g,   G = S (A / v + w P)^-1 w P + I - S,   L = S (A / v + w P)^-1 / v,
/// with A the second derivative of the energy of the data, g its gradient at the truth (see ScanAlignment for
/// both), v the variance of a residual that the prior P of weight w was weighed against, and S what was
/// taken of the alignment (see Observed). A prediction's error grows by the acceleration that is really
/// there: how much of the one that the filter allows follows from how far alignments were from their
/// predictions lately, beyond what G and L explain.
class MotionErrors {
 public:
  /// `covariance`: of pose and twist, order and frame as those of MotionPrior.
  void start(const Matrix12& covariance);

  /// The state became `outcome`, what was taken (S, of the pose and of the twist) of an alignment.
  void update(const MotionPrior& prior, const ScanAlignment& alignment, const Matrix6& taken, double variance,
              const MovingPose& outcome);
  /// The state became its prediction: the motion may have been all that the prior allows.
  void coast(const MotionPrior& prior);

  /// That share of the variance of the pose is from now on an error of the map, which the robot shares.
  void leave_to_map(double share);

  const Matrix12& covariance() const { return covariance_; }
  /// Of the variance of the acceleration that the filter allows along each axis of the body, the share that
  /// was there lately; all where nothing is known.
  Vector6 shares() const;

 private:
  /// Of the noise that a prior allows to a velocity along an axis, what was there: sums of squares, m^2/s^2
  /// or rad^2/s^2.
  struct Acceleration {
    double seen = 0;     ///< what updates moved the velocity by, beyond what errors explain
    double allowed = 0;  ///< what the noise would have made of that
    double share() const { return allowed > 0 ? seen / allowed : 1.0; }
  };

  Matrix12 covariance_ = Matrix12::Identity();
  bool velocity_known_ = false;                ///< before, that it changes tells no acceleration
  std::array<Acceleration, 4> accelerations_;  ///< x and y, z, roll and pitch, yaw: of the last second
};

}  // namespace scanlock
