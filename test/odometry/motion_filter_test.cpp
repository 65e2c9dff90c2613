// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/motion_filter.hpp"

#include <doctest/doctest.h>

namespace scanlock {
namespace {

using Vector12 = Eigen::Matrix<double, 12, 1>;

Vector6 lively() {
  return (Vector6() << 4, -0.5, 0.8, 0.3, -0.4, 0.6).finished();
}

MovingPose disturbed(const MovingPose& moving, const Vector12& by) {
  return {moving.pose * se3_exp(by.head<6>()), moving.twist + by.tail<6>()};
}

/// A filter with this state and covariance.
MotionFilter filter_at(const MovingPose& state, const Matrix12& covariance) {
  MotionFilter filter(5, 10);
  filter.start(state);
  MotionPrior prior;
  prior.mean = state;
  prior.information = inverse(covariance);
  filter.coast(prior);
  return filter;
}

}  // namespace

TEST_CASE("the covariance is carried by the derivative of the prediction") {
  const double dt = 0.13, step = 1e-6;
  const MovingPose state{se3_exp(0.7 * lively()), lively()};
  Matrix12 covariance = 1e-4 * Matrix12::Identity();
  covariance.bottomRightCorner<6, 6>() *= 30;
  const MotionFilter filter = filter_at(state, covariance);
  const MotionPrior predicted = filter.predict(dt);

  // The mean velocity is fixed: only the state is perturbed.
  Matrix12 derivative;
  for (int k = 0; k < 12; ++k) {
    Vector12 by = Vector12::Zero();
    by[k] = step;
    MotionFilter other = filter;
    MotionPrior moved;
    moved.mean = disturbed(state, by);
    moved.information = inverse(covariance);
    other.coast(moved);
    const MovingPose there = other.predict(dt).mean;
    derivative.col(k).head<6>() = se3_log(predicted.mean.pose.inverse() * there.pose) / step;
    derivative.col(k).tail<6>() = (there.twist - predicted.mean.twist) / step;
  }
  const Matrix12 noise_less = derivative * covariance * derivative.transpose();
  const Matrix12 noise = inverse(predicted.information) - noise_less;
  // The remaining part is the white noise of the acceleration: its density times dt^3 / 3, dt^2 / 2 and dt,
  // and a floor.
  for (int k = 0; k < 6; ++k) {
    const double density = (k < 3 ? 25.0 : 100.0) * 0.3, floor = 1e-6;
    CHECK(noise(k, k) == doctest::Approx(density * dt * dt * dt / 3 + floor).epsilon(1e-3));
    CHECK(noise(k, k + 6) == doctest::Approx(density * dt * dt / 2).epsilon(1e-3));
    CHECK(noise(k + 6, k + 6) == doctest::Approx(density * dt + floor).epsilon(1e-3));
  }
  CHECK((noise - Matrix12(noise.diagonal().asDiagonal())).topLeftCorner<6, 6>().norm() < 1e-5);
}

TEST_CASE("a body may accelerate along all axes within a scan, and a planar body along those of its plane") {
  MotionFilter filter(5, 10);
  filter.start({Pose::Identity(), lively()});
  Vector6 expected;
  expected << 7.5, 7.5, 7.5, 30, 30, 30;
  CHECK(filter.predict(0.1).acceleration_density.isApprox(expected));
  CHECK(filter.predict(0).acceleration_density.isApprox(expected));
  filter.set_planar(true);
  expected.segment<3>(2).setZero();
  CHECK(filter.predict(0.1).acceleration_density.isApprox(expected));
}

TEST_CASE(
    "predicted speed, drift and turn rate persist, and rates of z, roll and pitch return to their mean") {
  MotionFilter filter(5, 10);
  filter.start({Pose::Identity(), Vector6::Zero()});
  MotionPrior jolt = filter.predict(0.001);
  jolt.mean.twist = lively();
  filter.coast(jolt);
  const Vector6 later = filter.predict(2.0).mean.twist;
  for (const int axis : {0, 1, 5}) CHECK(later[axis] == doctest::Approx(lively()[axis]));
  for (const int axis : {2, 3, 4}) CHECK(std::abs(later[axis]) < 0.01);
}

TEST_CASE("a long climb is predicted to continue, and a body at rest to stay") {
  MotionFilter filter(5, 10);
  filter.start({Pose::Identity(), Vector6::Zero()});
  for (int i = 0; i < 200; ++i) {
    MotionPrior climbing = filter.predict(0.1);
    climbing.mean.twist = lively();
    filter.coast(climbing);
  }
  CHECK(filter.predict(2.0).mean.twist[2] == doctest::Approx(0.8).epsilon(0.01));
  filter.stand();
  for (int i = 0; i < 50; ++i) {
    const Pose before = filter.state().pose;
    filter.coast(filter.predict(0.1));
    CHECK(filter.state().pose.isApprox(before, 1e-12));
  }
}

}  // namespace scanlock
