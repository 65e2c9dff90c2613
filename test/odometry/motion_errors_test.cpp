// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/motion_errors.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <random>

#include "../trials.hpp"
#include "odometry/motion_filter.hpp"

namespace scanlock {
namespace {

constexpr double kPeriod = 0.1;        // seconds
constexpr double kAcceleration = 5.0;  // m/s^2, standard deviation in the filter
const Matrix6 kAll = Matrix6::Identity();

struct Random {
  std::mt19937 engine;
  std::normal_distribution<double> normal{0.0, 1.0};

  Vector12 of(const Matrix12& covariance) {
    Vector12 unit;
    for (double& u : unit) u = normal(engine);
    return covariance.llt().matrixL() * unit;
  }
};

/// A robot at constant velocity, with random accelerations whose variance is `share` of that in the filter.
struct FilteredDrive {
  MotionFilter filter{kAcceleration, 10.0};
  MotionErrors errors;
  MovingPose truth;
  Random random;

  explicit FilteredDrive(unsigned seed, double turn_rate = 0.1) {
    random.engine.seed(seed);
    truth.twist << 2, 0, 0, 0, 0, turn_rate;
    filter.start({truth.pose, truth.twist});
    errors.start(filter.covariance());
  }

  Vector12 error() const {
    Vector12 e;
    e << se3_log(truth.pose.inverse() * filter.state().pose), filter.state().twist - truth.twist;
    return e;
  }

  /// One scan with the information `data`: residuals have the variance `real`, and the filter assumes
  /// `assumed`.
  void step(const Matrix12& data, double real, double assumed, double share) {
    step(data, real, assumed, Eigen::Vector3d::Constant(share));
  }
  /// `share`: along x, y and z.
  void step(const Matrix12& data, double real, double assumed, const Eigen::Vector3d& share) {
    const MotionPrior prior = filter.predict(kPeriod);
    Vector12 part;  // hardly any rotation, so that the axes of the body stay those of the world
    part.head<3>() = share;
    part.segment<3>(3).setConstant(1e-4 * share.maxCoeff());
    part.tail<6>() = part.head<6>();
    const Vector12 root = part.cwiseSqrt();
    const Vector12 done =
        random.of(root.asDiagonal() * prior.noise * root.asDiagonal() + 1e-12 * Matrix12::Identity());
    truth.pose = truth.pose * se3_exp(kPeriod * truth.twist) * se3_exp(done.head<6>());
    truth.twist += done.tail<6>();

    ScanAlignment alignment;
    alignment.information = data;
    alignment.scatter = real * data;
    // The error of an alignment by the data alone; small information is added along directions that the data
    // leave open.
    const Vector12 off = random.of(real * inverse(Matrix12(data + 1e-3 * Matrix12::Identity())));
    Vector12 seen;
    seen << se3_log(prior.mean.pose.inverse() * truth.pose) + off.head<6>(),
        truth.twist - prior.mean.twist + off.tail<6>();
    Vector12 e = seen;
    for (int round = 0; round < 200; ++round) {  // iterates to where the sum of both gradients is zero
      const Matrix12 held = prior_weight(e.dot(prior.information * e)) * prior.information;
      e = 0.5 * (e + inverse(Matrix12(data / assumed + held)) * (data / assumed * seen));
    }
    alignment.moving = {prior.mean.pose * se3_exp(e.head<6>()), prior.mean.twist + e.tail<6>()};
    errors.update(prior, alignment, kAll, assumed, alignment.moving);
    filter.update(prior, alignment, assumed);
  }
};

Matrix12 strong_data() {
  Vector12 diagonal;
  diagonal << 400, 500, 300, 900, 800, 1000, 4, 5, 3, 9, 8, 10;
  Matrix12 data = diagonal.asDiagonal();
  data(0, 6) = data(6, 0) = 15;  // the pose at the stamp and the velocity come from the same points
  return data;
}

/// The mean normalised squared error of the pose per degree of freedom: 1 where the covariance is correct.
double normalised_error(double assumed, double share) {
  double sum = 0;
  const int drives = trials(120), scans = 60;
  int count = 0;
  for (int d = 0; d < drives; ++d) {
    FilteredDrive drive(static_cast<unsigned>(d + 1));
    for (int k = 0; k < scans; ++k) {
      drive.step(strong_data(), 1e-3, assumed, share);
      if (k < 40) continue;
      const Vector6 e = drive.error().head<6>();
      const Matrix6 covariance = drive.errors.covariance().topLeftCorner<6, 6>();
      sum += e.dot(inverse(covariance) * e) / 6;
      ++count;
    }
  }
  return sum / count;
}

/// The estimated shares at the end of a drive, mean over drives.
Vector6 told_shares(const Eigen::Vector3d& share) {
  Vector6 sum = Vector6::Zero();
  const int drives = 40;
  for (int d = 0; d < drives; ++d) {
    FilteredDrive drive(static_cast<unsigned>(d + 1));
    for (int k = 0; k < 40; ++k) drive.step(strong_data(), 1e-3, 1e-3, share);
    sum += drive.errors.shares() / drives;
  }
  return sum;
}

}  // namespace

TEST_CASE("the shares of acceleration follow the recent motion, for driving and for swinging") {
  CHECK(MotionErrors().shares() == Vector6::Ones());  // without data
  const Vector6 driven = told_shares({0.5, 0.5, 0.01}), swung = told_shares({0.01, 0.01, 0.5});
  for (const int axis : {0, 1}) {
    CHECK(driven[axis] == doctest::Approx(0.5).epsilon(0.2));
    CHECK(swung[axis] < 0.1);
  }
  CHECK(driven[2] < 0.1);
  CHECK(swung[2] == doctest::Approx(0.5).epsilon(0.25));
}

TEST_CASE("the covariance matches the errors, whatever noise the filter assumes" *
          doctest::test_suite("many trials")) {
  for (const double assumed : {1e-3, 3e-2}) {
    for (const double share : {0.01, 0.3}) {
      CAPTURE(assumed);
      CAPTURE(share);
      const double normalised = normalised_error(assumed, share);
      CHECK(normalised > 0.6);
      CHECK(normalised < 1.5);
    }
  }
}

TEST_CASE("the covariance of an unconstrained axis keeps growing") {
  Matrix12 data = strong_data();
  data.row(0).setZero();
  data.col(0).setZero();
  data.row(6).setZero();
  data.col(6).setZero();
  data(0, 0) = data(6, 6) = 1e-9;
  FilteredDrive drive(3, 0.0);  // no rotation, for that would in time constrain the open direction
  for (int k = 0; k < 5; ++k) drive.step(strong_data(), 1e-3, 1e-3, 0.1);
  const double known = drive.errors.covariance()(0, 0);
  double last = known;
  for (int stretch = 0; stretch < 3; ++stretch) {
    for (int k = 0; k < 10; ++k) drive.step(data, 1e-3, 1e-3, 0.1);
    CHECK(drive.errors.covariance()(0, 0) > 2 * last);
    last = drive.errors.covariance()(0, 0);
  }
  CHECK(last > 100 * known);
  CHECK(drive.errors.covariance()(1, 1) < 0.01 * last);
}

TEST_CASE("an abrupt motion raises the covariance in the scan that shows it") {
  FilteredDrive drive(4);
  for (int k = 0; k < 50; ++k) drive.step(strong_data(), 1e-4, 3e-2, 0.001);
  const double calm = drive.errors.covariance()(1, 1);
  drive.truth.twist[1] += 2.0;
  drive.step(strong_data(), 1e-4, 3e-2, 0.001);
  CHECK(drive.errors.covariance()(1, 1) > 10 * calm);
}

TEST_CASE("leave_to_map moves the share of new ground from the covariance of the pose to the map") {
  MotionErrors errors;
  Matrix12 covariance = strong_data() * 1e-3;
  errors.start(covariance);
  errors.leave_to_map(0.25);
  CHECK(errors.covariance().topLeftCorner<6, 6>().isApprox(0.75 * covariance.topLeftCorner<6, 6>()));
  CHECK(errors.covariance().bottomRightCorner<6, 6>().isApprox(covariance.bottomRightCorner<6, 6>()));
  CHECK(errors.covariance().llt().info() == Eigen::Success);
  errors.leave_to_map(1.0);
  CHECK(errors.covariance().topRows<6>().isZero());
}

}  // namespace scanlock
