// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/motion_errors.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/elementary.hpp"
#include "odometry/motion_filter.hpp"

namespace scanlock {
namespace {

/// Axes of the body that accelerate alike: those of driving, and those of swinging (see MotionFilter).
struct Kind {
  int first, last;
};
constexpr std::array<Kind, 4> kKinds = {{{0, 1}, {2, 2}, {3, 4}, {5, 5}}};

constexpr double kLately = 1.0;  // seconds: a body accelerates about as it did in the last second

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
  // For a prior that was not predicted from a state, its own covariance is taken.
  Matrix12 predicted = prior.ahead_s > 0 ? carried : inverse(prior.information);
  if (prior.ahead_s > 0 && !velocity_known_) predicted += prior.noise;
  if (prior.ahead_s > 0 && velocity_known_) {
    // The update moved the state by (G - I) e_predicted + L g.
    const Matrix12 moved = g - Matrix12::Identity();
    const Vector12 explained = (moved * carried * moved.transpose() + measured).diagonal();
    const Vector6 by = outcome.twist - prior.mean.twist;
    const double kept = exp(-prior.ahead_s / kLately);
    Vector12 root;
    for (std::size_t k = 0; k < accelerations_.size(); ++k) {
      const Kind kind = kKinds[k];
      Acceleration now, &lately = accelerations_[k];
      for (int axis = kind.first; axis <= kind.last; ++axis) {
        const int velocity = axis + 6;
        // The noise along an axis acts on its position and on its velocity.
        const Eigen::Vector2d response(moved(velocity, axis), moved(velocity, velocity));
        Eigen::Matrix2d noise;
        noise << prior.noise(axis, axis), prior.noise(axis, velocity), prior.noise(velocity, axis),
            prior.noise(velocity, velocity);
        now.allowed += response.dot(noise * response);
        now.seen += by[axis] * by[axis] - explained[velocity];
      }
      now.seen = std::max(now.seen, 0.0);
      // Until there is a measurement, all of the allowed acceleration is assumed.
      if (lately.allowed <= 0) lately = {now.allowed, now.allowed};
      lately.seen = kept * lately.seen + now.seen;
      lately.allowed = kept * lately.allowed + now.allowed;
      // An acceleration that this scan shows counts at once, even if the scans before it showed none.
      const double present = std::sqrt(std::max(lately.share(), now.share()));
      for (int axis = kind.first; axis <= kind.last; ++axis) root[axis] = root[axis + 6] = present;
    }
    predicted += root.asDiagonal() * prior.noise * root.asDiagonal();
  }
  velocity_known_ = true;
  covariance_ = g * predicted * g.transpose() + measured;
}

Vector6 MotionErrors::shares() const {
  Vector6 result;
  for (std::size_t k = 0; k < kKinds.size(); ++k)
    for (int axis = kKinds[k].first; axis <= kKinds[k].last; ++axis) result[axis] = accelerations_[k].share();
  return result;
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
