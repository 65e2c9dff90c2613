// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/degeneracy.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

using namespace scanlock;

namespace {

constexpr int kPoints = 4000;

/// H = sum j j^T, j = [n; p x n].
Matrix6 add(Matrix6 information, const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
  Vector6 j;
  j << n, p.cross(n);
  return information + j * j.transpose();
}

struct Scene {
  Matrix6 information = Matrix6::Zero();
  Matrix6 noise = Matrix6::Zero();  ///< the expected part of it from errors of the normals
};

/// A pipe along x around the sensor, whose normals have errors of `noise` (radians) along x; the share `ribs`
/// of its surface has normals along x.
Scene pipe(double noise, double ribs = 0) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal(0, noise);
  Scene scene;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 3.14159 * uniform(rng), y = std::cos(angle), z = std::sin(angle);
    const Eigen::Vector3d p(20 * uniform(rng), 3 * y, 3 * z);
    const Eigen::Vector3d wall = Eigen::Vector3d(normal(rng), y, z).normalized();
    scene.information = add(scene.information, p, i < ribs * kPoints ? Eigen::Vector3d::UnitX() : wall);
    scene.noise = add(scene.noise, p, noise * Eigen::Vector3d::UnitX());
  }
  return scene;
}

/// The axes along which a scan determines the pose less well than the prediction, without the part of its
/// information that comes from errors of the normals; residuals have an error of 3 cm that ten of them share.
std::uint32_t open(const Scene& scene, const Matrix6& predicted = Matrix6::Identity() * 0.05 * 0.05) {
  const double variance = 10 * 0.03 * 0.03;
  const Matrix6 information = scene.information / variance;
  const Matrix6 real = observed(information, scene.noise / variance, predicted).information;
  const Matrix6 covariance = (real.transpose() * information * real + predicted.inverse()).inverse();
  std::uint32_t axes = 0;
  for (int axis = 0; axis < 6; ++axis)
    if (!(covariance(axis, axis) < 0.5 * predicted(axis, axis))) axes |= 1u << axis;
  return axes;
}

}  // namespace

TEST_CASE("a room leaves no axis unconstrained") {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Matrix6 room = Matrix6::Zero();
  for (int i = 0; i < kPoints; ++i) {
    const int axis = i % 3;
    Eigen::Vector3d p(4 * uniform(rng), 3 * uniform(rng), 2 * uniform(rng));
    p[axis] = i % 2 ? 3 : -3;
    room = add(room, p, Eigen::Vector3d::Unit(axis));
  }
  CHECK(find_degeneracy(room).axes == 0);
  CHECK(open({room, 0.05 * room}) == 0);
}

TEST_CASE("a pipe leaves the translation along its axis and the rotation about it open, and nothing else") {
  for (const double noise : {0.0, 0.01, 0.03, 0.1}) {
    CAPTURE(noise);
    // The rotation about the pipe's axis is open, too.
    CHECK(open(pipe(noise)) == 0b001001);
  }
  CHECK((open(pipe(0.03, 0.05)) & 1u) == 0);  // with ribs
  // If no errors of the normals are assumed, the direction counts as observed.
  Scene rough = pipe(0.1);
  rough.noise.setZero();
  CHECK((open(rough) & 1u) == 0);
}

TEST_CASE("whether a scan constrains an axis depends on the predicted covariance") {
  const Scene ribbed = pipe(0, 0.005);
  const auto along = [&](double metres) {
    Matrix6 predicted = Matrix6::Identity();
    predicted(0, 0) = metres * metres;
    return open(ribbed, predicted) & 1u;
  };
  CHECK(along(0.001) == 1u);  // twenty points with errors of centimetres do not determine millimetres
  CHECK(along(1.0) == 0u);
}
