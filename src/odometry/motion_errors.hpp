// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include "icp/scan_alignment.hpp"

namespace scanlock {

/// The covariance of the estimate of a motion filter, derived from the scans and not from the filter's own
/// assumptions. The outcome of an alignment with a prior is where the gradient of both together is zero; to
/// first order its error is
///   e = G e_predicted + L g,   G = S (A / v + w P)^-1 w P + I - S,   L = S (A / v + w P)^-1 / v,
/// with A the second derivative of the energy of the data, g its gradient at the true pose (see ScanAlignment
/// for both), v the variance of a residual against which the prior P of weight w was weighed, and S the part
/// of the alignment's motion that was accepted (see Observed). The error of a prediction grows by the
/// acceleration that really occurs. The share of the allowed acceleration that occurs is estimated from the
/// distances of recent alignments from their predictions, beyond the distances that G and L explain.
class MotionErrors {
 public:
  /// `covariance`: of pose and twist, order and frame as those of MotionPrior.
  void start(const Matrix12& covariance);

  /// Call when the state has become `outcome`: the part `taken` (S, for the pose and for the twist) of an
  /// alignment. `variance`: v, m^2.
  void update(const MotionPrior& prior, const ScanAlignment& alignment, const Matrix6& taken, double variance,
              const MovingPose& outcome);
  /// Call when the state has become its prediction: the motion may differ from it by as much as the prior
  /// allows.
  void coast(const MotionPrior& prior);

  /// Removes this share (0 to 1) of the pose's variance: from now on it is an error of the map, in which the
  /// robot shares, and no longer one relative to the map.
  void leave_to_map(double share);

  const Matrix12& covariance() const { return covariance_; }
  /// For each axis of the body (order as in a twist) the share of the variance of the acceleration allowed by
  /// the filter that occurred lately, about the last second; 1 where nothing is known.
  Vector6 shares() const;

 private:
  /// How much of the velocity noise that a prior allows along an axis occurred: sums of squares, m^2/s^2 or
  /// rad^2/s^2.
  struct Acceleration {
    double seen = 0;     ///< changes of the velocity by updates, beyond those that errors explain
    double allowed = 0;  ///< changes of the velocity to expect from the allowed noise
    double share() const { return allowed > 0 ? seen / allowed : 1.0; }
  };

  Matrix12 covariance_ = Matrix12::Identity();
  bool velocity_known_ = false;  ///< until it is true, a changed velocity indicates no acceleration
  std::array<Acceleration, 4> accelerations_;  ///< x and y, z, roll and pitch, yaw: of the last second
};

}  // namespace scanlock
