// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/motion_errors.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/elementary.hpp"
#include "odometry/motion_filter.hpp"

namespace scanlock {
namespace {

constexpr double kLately = 1.0;  // seconds: a body accelerates about as it did in the last second

/// The noise of the translation (first = 0) or of the rotation (3), with that of their velocities.
Matrix12 part_of(const Matrix12& noise, int first) {
  Matrix12 part = Matrix12::Zero();
  for (const int row : {first, first + 6}) {
    for (const int column : {first, first + 6})
      part.block<3, 3>(row, column) = noise.block<3, 3>(row, column);
  }
  return part;
}

/// The sum of the variances of three velocities.
double of_velocity(const Matrix12& covariance, int first) {
  return covariance.diagonal().segment<3>(first + 6).sum();
}

}  // namespace

void MotionErrors::start(const Matrix12& covariance) {
  covariance_ = covariance;
  accelerations_ = {};
  velocity_known_ = false;
}

void MotionErrors::update(const MotionPrior& prior, const ScanAlignment& alignment, const Matrix6& taken,
                          double variance, const MovingPose& outcome) {
  Matrix12 share = Matrix12::Zero();
  share.topLeftCorner<6, 6>() = share.bottomRightCorner<6, 6>() = taken;
  const Matrix12 held = prior_weight(squared_gap(prior, alignment.moving)) * prior.information;
  const Matrix12 from_data =
      share * inverse(Matrix12(alignment.curvature / variance * alignment.information + held));
  // e = G e_predicted + L g
  const Matrix12 g = from_data * held + Matrix12::Identity() - share;
  const Matrix12 measured = from_data * (alignment.scatter / (variance * variance)) * from_data.transpose();
  const Matrix12 carried = prior.transition * covariance_ * prior.transition.transpose();
  // A prior that was not predicted from a state is taken at its word.
  Matrix12 predicted = prior.ahead_s > 0 ? carried : inverse(prior.information);
  if (prior.ahead_s > 0 && !velocity_known_) predicted += prior.noise;
  if (prior.ahead_s > 0 && velocity_known_) {
    // What the update moved the state by is (G - I) e_predicted + L g.
    const Matrix12 moved = g - Matrix12::Identity();
    const Matrix12 explained = moved * carried * moved.transpose() + measured;
    const Vector6 by = outcome.twist - prior.mean.twist;
    const double kept = exp(-prior.ahead_s / kLately);
    for (const int first : {0, 3}) {
      Acceleration& acceleration = accelerations_[static_cast<std::size_t>(first / 3)];
      const Matrix12 noise = part_of(prior.noise, first);
      Acceleration now;
      now.allowed = of_velocity(moved * noise * moved.transpose(), first);
      now.seen = std::max(by.segment<3>(first).squaredNorm() - of_velocity(explained, first), 0.0);
      // Before anything is known all of it may be there.
      if (acceleration.allowed <= 0) acceleration = {now.allowed, now.allowed};
      acceleration.seen = kept * acceleration.seen + now.seen;
      acceleration.allowed = kept * acceleration.allowed + now.allowed;
      // What one scan shows for certain is there, though there was none before.
      predicted += std::max(acceleration.share(), now.share()) * noise;
    }
  }
  velocity_known_ = true;
  covariance_ = g * predicted * g.transpose() + measured;
}

void MotionErrors::coast(const MotionPrior& prior) {
  covariance_ = prior.transition * covariance_ * prior.transition.transpose() + prior.noise;
}

void MotionErrors::leave_to_map(double share) {
  const double kept = std::sqrt(1.0 - share);
  covariance_.topRows<6>() *= kept;
  covariance_.leftCols<6>() *= kept;
}

}  // namespace scanlock
