// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/degeneracy.hpp"

#include <doctest/doctest.h>

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
  Matrix6 noise = Matrix6::Zero();  ///< the part of it that errors of the normals make, as expected
};

/// A pipe along x about the sensor, its normals off along it by `noise` (radians); of its surface, the share
/// `ribs` looks along it.
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

Matrix6 observed(const Scene& scene) {
  return observed_motion(scene.information, scene.noise);
}

Vector6 motion(double x, double y, double z, double roll, double pitch, double yaw) {
  return (Vector6() << x, y, z, roll, pitch, yaw).finished();
}

}  // namespace

TEST_CASE("a room is observed, to the bit") {
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
  CHECK(observed_motion(room, 0.05 * room) == Matrix6::Identity());
}

TEST_CASE("of a motion in a pipe only the part along it is taken away, however its normals are off") {
  for (const double noise : {0.0, 0.01, 0.03, 0.1}) {
    CAPTURE(noise);
    const Scene scene = pipe(noise);
    const Matrix6 taken = observed(scene);
    CHECK((find_degeneracy(scene.information, scene.noise).axes & 1u) == 1u);
    CHECK((taken * motion(1, 0, 0, 0, 0, 0)).norm() < 0.02);
    for (const Vector6& other : {motion(0, 1, 0, 0, 0, 0), motion(0, 0, 1, 0, 0, 0), motion(0, 0, 0, 1, 0, 0),
                                 motion(0, 0, 0, 0, 0.1, 0), motion(0, 0, 0, 0, 0, 0.1)})
      CHECK((taken * other - other).norm() < 0.02);
  }
  CHECK(observed(pipe(0.03, 0.01)) == Matrix6::Identity());  // ribs: few, but no noise
  const Scene rough = pipe(0.1);                             // taken at its word it is observed
  CHECK((find_degeneracy(rough.information).axes & 1u) == 0);
}

TEST_CASE("a slide that turns the robot is taken away with its turn") {
  // A wall around the z axis through (0, 5, 0), and a floor: the robot goes round without being seen to.
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::Vector3d centre(0, 5, 0);
  Matrix6 information = Matrix6::Zero();
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 3.14159 * uniform(rng);
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
    information = i % 2 ? add(information, centre + 8 * out + Eigen::Vector3d(0, 0, uniform(rng)), out)
                        : add(information, centre + 6 * uniform(rng) * out - Eigen::Vector3d::UnitZ(),
                              Eigen::Vector3d::UnitZ());
  }
  const Vector6 slide = motion(1, 0, 0, 0, 0, 0.2);  // v = -omega x centre
  REQUIRE(slide.dot(information * slide) < 1e-9 * information.trace());
  CHECK((observed_motion(information, Matrix6::Zero()) * slide).norm() < 1e-6);
}

TEST_CASE("what is taken away grows without a jump") {
  double before = 0;
  for (double ribs = 0; ribs < 0.01; ribs += 0.00025) {
    const double kept = observed(pipe(0.04, ribs))(0, 0);
    CHECK(kept > before - 1e-4);
    CHECK(kept - before < 0.25);
    before = kept;
  }
  CHECK(before == 1);
}
