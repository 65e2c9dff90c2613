// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/motion_filter.hpp"

#include <algorithm>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr int kSwinging[] = {2, 3, 4};  // z, roll, pitch: moved by hands, legs and springs

// Standard deviations of the velocity of a robot when it is first seen.
constexpr double kStartSpeed = 10.0;    // m/s
constexpr double kStartTurnRate = 1.5;  // rad/s

}  // namespace

MotionFilter::MotionFilter(double acceleration, double angular_acceleration)
    : linear_density_(acceleration * acceleration * kManoeuvre),
      angular_density_(angular_acceleration * angular_acceleration * kManoeuvre) {}

void MotionFilter::start(const MovingPose& guess) {
  state_ = guess;
  mean_twist_ = guess.twist;
  Eigen::Matrix<double, 12, 1> sigma;
  sigma.head<6>().setConstant(kPoseFloor);
  sigma.segment<3>(6).setConstant(kStartSpeed);
  sigma.tail<3>().setConstant(kStartTurnRate);
  covariance_ = sigma.cwiseAbs2().asDiagonal();
  set_planar(planar_);
}

void MotionFilter::set_planar(bool planar) {
  planar_ = planar;
  if (!planar) return;
  for (int axis : {2, 3, 4, 8, 9, 10}) {  // z, roll, pitch, and their velocities
    covariance_.row(axis).setZero();
    covariance_.col(axis).setZero();
    covariance_(axis, axis) = kPoseFloor * kPoseFloor;
  }
}

MotionPrior MotionFilter::predict(double dt) const {
  MotionPrior prior;
  prior.ahead_s = dt;
  Vector6 kept = Vector6::Ones();        // factor on a velocity's deviation from its mean, after dt
  Vector6 time = Vector6::Constant(dt);  // seconds at the present deviation that cover the same distance
  for (const int axis : kSwinging) {
    kept[axis] = exp(-dt / kReturn);
    time[axis] = kReturn * (1 - kept[axis]);
  }
  const Vector6 deviation = state_.twist - mean_twist_;
  const Vector6 step = dt * mean_twist_ + time.cwiseProduct(deviation);
  prior.mean.pose = renormalised(state_.pose * se3_exp(step));
  prior.mean.twist = mean_twist_ + kept.cwiseProduct(deviation);

  Matrix12& transition = prior.transition;
  transition.topLeftCorner<6, 6>() = adjoint(se3_exp(-step));
  // se3_left_jacobian(-step) is the right Jacobian at step.
  transition.topRightCorner<6, 6>() = se3_left_jacobian(-step) * time.asDiagonal();
  transition.bottomRightCorner<6, 6>() = kept.asDiagonal();
  Vector6 density;
  density << Eigen::Vector3d::Constant(linear_density_), Eigen::Vector3d::Constant(angular_density_);
  if (planar_) density.segment<3>(2).setZero();
  prior.acceleration_density = density;
  Matrix12& noise = prior.noise;
  noise.diagonal() << density * (dt * dt * dt / 3.0), density * dt;
  noise.topRightCorner<6, 6>().diagonal() = density * (dt * dt / 2.0);
  noise.bottomLeftCorner<6, 6>().diagonal() = density * (dt * dt / 2.0);
  noise.diagonal().head<6>().array() += kPoseFloor * kPoseFloor;
  noise.diagonal().tail<6>().array() += kPoseFloor * kPoseFloor;
  prior.information = inverse(Matrix12(transition * covariance_ * transition.transpose() + noise));
  return prior;
}

MotionPrior MotionFilter::predict(double dt, const Pose& motion) const {
  MotionPrior prior = predict(dt);
  if (!(dt > 0)) return prior;
  Vector6 step = se3_log(motion);
  if (planar_) step.segment<3>(2).setZero();  // z, roll, pitch
  prior.mean.pose = renormalised(state_.pose * (planar_ ? se3_exp(step) : motion));
  prior.mean.twist = step / dt;
  return prior;
}

void MotionFilter::update(const MotionPrior& prior, const ScanAlignment& alignment, double variance) {
  state_ = alignment.moving;
  state_.pose = renormalised(state_.pose);
  follow_mean(prior.ahead_s);
  // An outcome near the prediction adds no information along directions without data: the weight is at most
  // 1.
  const double weight = std::min(prior_weight(squared_gap(prior, alignment.moving)), 1.0);
  covariance_ = inverse(Matrix12(weight * prior.information + alignment.information / variance));
}

void MotionFilter::coast(const MotionPrior& prior) {
  state_ = prior.mean;
  follow_mean(prior.ahead_s);
  covariance_ = inverse(prior.information);
}

void MotionFilter::stand() {
  state_.twist.setZero();
  state_.acceleration.setZero();
  mean_twist_.setZero();
}

void MotionFilter::follow_mean(double seconds) {
  mean_twist_ += (1 - exp(-seconds / kMeanOver)) * (state_.twist - mean_twist_);
}

Matrix12 prior_information(double metres, double radians, const Matrix12& covariance) {
  Matrix12 information = Matrix12::Zero();
  information.diagonal().head<3>().setConstant(1.0 / (metres * metres));
  information.diagonal().segment<3>(3).setConstant(1.0 / (radians * radians));
  Matrix6 velocity = covariance.bottomRightCorner<6, 6>();
  velocity.diagonal().array() += 0.01;
  information.bottomRightCorner<6, 6>() = inverse(velocity);
  return information;
}

double squared_gap(const MotionPrior& prior, const MovingPose& moving) {
  Eigen::Matrix<double, 12, 1> error;
  error << se3_log(prior.mean.pose.inverse() * moving.pose), moving.twist - prior.mean.twist;
  return error.dot(prior.information * error);
}

Matrix6 pose_covariance(const MotionPrior& prior) {
  return inverse(prior.information).topLeftCorner<6, 6>();
}

MotionPrior loosened(MotionPrior prior) {
  prior.information *= 0.01;
  return prior;
}

}  // namespace scanlock
