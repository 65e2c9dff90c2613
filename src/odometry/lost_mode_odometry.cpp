// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/lost_mode_odometry.hpp"

#include <utility>

namespace scanlock {
LostModeOdometry::LostModeOdometry(const TrackerConfig& config, std::int64_t utime, const PreparedScan& scan,
                                   const MovingPose& predicted)
    : config_(config),
      odometer_(std::make_unique<Odometer>(config)),
      seen_(static_cast<std::size_t>(config.max_archive_points)) {
  odometer_->start(utime, scan, predicted);
}

bool LostModeOdometry::follow(std::int64_t utime, double dt, const PreparedScan& scan) {
  const MotionPrior prior = odometer_->predict(dt);
  Attempt attempt = odometer_->awaits_second()
                        ? odometer_->align(part_of(scan, kDeskewPoints), prior, Reach::kNear)
                        : odometer_->align(scan, prior, Reach::kNear);
  attempt = odometer_->deskew_first(scan, dt, std::move(attempt), false);
  if (!explains(attempt, kJumpScore)) {
    attempt = better(std::move(attempt), odometer_->probe(scan, loosened(prior), Reach::kFar));
  }
  if (!explains(attempt, kJumpScore) || squared_gap(prior, attempt.alignment.moving) > kMostGap) {
    // The velocity before the first alignment is a guess: one that the second scan contradicts is dropped.
    begin_anew(utime, scan, {prior.mean.pose, scans_ == 1 ? Vector6::Zero() : prior.mean.twist});
    return false;
  }
  blind_s_ = 0;
  odometer_->accept(attempt);
  followed_s_ += dt;
  odometer_->keep(utime, scan, attempt.health.inlier_ratio);
  remember(utime, scan);
  attempt_ = std::move(attempt);
  ++scans_;
  return true;
}

Surroundings LostModeOdometry::surroundings() const {
  const Pose& here = state().pose;
  return {odometer_->map(), here, seen_.empty() ? 0 : seen_.scene(here.translation()), scans_, up()};
}

void LostModeOdometry::begin_anew(std::int64_t utime, const PreparedScan& scan, const MovingPose& predicted) {
  odometer_->start(utime, scan, predicted);
  seen_.clear();
  up_sum_.setZero();
  blind_s_ = followed_s_ = 0;
  scans_ = 1;
}

void LostModeOdometry::remember(std::int64_t utime, const PreparedScan& scan) {
  const Pose& here = odometer_->state().pose;
  if (!seen_.wants(utime, here.translation(), scan.median_range)) return;
  const Matrix6 covariance = odometer_->take_new_drift();
  std::optional<Constraint> constraint;
  if (!seen_.empty()) constraint = constraint_to(seen_.keyframes().back(), here, covariance);
  seen_.add(utime, here, scan.median_range, deskewed(scan.source, odometer_->state()), constraint);
}

void LostModeOdometry::coast(double dt) {
  blind_s_ += dt;
  if (blind_s_ > kCoastSeconds) followed_s_ = 0;
  odometer_->coast(odometer_->predict(dt));
  if (blind_s_ > kCoastSeconds) odometer_->stand();
}

void LostModeOdometry::note_up(const Eigen::Vector3d& up_in_body) {
  up_sum_ += odometer_->state().pose.linear() * up_in_body;
}

std::optional<Eigen::Vector3d> LostModeOdometry::up() const {
  // Length of the sum of unit vectors: below it they have no common direction.
  constexpr double kOneDirection = 0.5;
  if (!(up_sum_.norm() > kOneDirection)) return std::nullopt;
  return up_sum_.normalized();
}

}  // namespace scanlock
