// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/degeneracy.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace scanlock {
namespace {

// Open fields are about so weak.
constexpr double kWeakTranslation = 0.0045;
constexpr double kWeakRotation = 0.003;
// A weak direction is charged to the body axes that make up most of it.
constexpr double kShareOfAxis = 0.5;

// What H has along a direction over what noise alone would give it: 0.5 to 3 in smooth tunnels, 2.5 and more
// in bare corridors, 10 and more in streets, rooms, woods and fields. A direction is named open a little
// sooner than it is taken for it.
constexpr double kNoise = 2.5, kSignal = 4.0, kNamed = 5.0;
constexpr double kNothing = 1e-6;  // of the trace: open, whatever the noise

Eigen::Matrix3d inverse(const Eigen::Matrix3d& block) {
  return (block + Eigen::Matrix3d::Identity() * (1e-9 * block.trace() + 1e-300)).inverse();
}

/// A motion that a scene holds more or less than the two others of its kind (translations, or rotations).
struct Direction {
  Vector6 motion;       ///< unit in its own three; with it what the other three do that give way to it
  double known, noise;  ///< information along it and the part that noise makes, over the trace of its block
};

/// `first`: 0 for translations, 3 for rotations. The least known comes first.
std::array<Direction, 3> directions_of(const Matrix6& information, const Matrix6& noise, int first) {
  const int other = 3 - first;
  const Eigen::Matrix3d kept = information.block<3, 3>(first, first);
  const Eigen::Matrix3d follow =
      -inverse(information.block<3, 3>(other, other)) * information.block<3, 3>(other, first);
  const double trace = kept.trace();
  Eigen::Vector3d known = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  if (trace > 0) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
        (kept + information.block<3, 3>(first, other) * follow) / trace);
    known = solver.eigenvalues();
    axes = solver.eigenvectors();
  }
  std::array<Direction, 3> result;
  for (int k = 0; k < 3; ++k) {
    Direction& direction = result[static_cast<std::size_t>(k)];
    direction.motion.segment<3>(first) = axes.col(k);
    direction.motion.segment<3>(other) = follow * axes.col(k);
    direction.known = known[k];
    direction.noise = trace > 0 ? direction.motion.dot(noise * direction.motion) / trace : 0;
  }
  return result;
}

double examine(const std::array<Direction, 3>& directions, double threshold, int first, std::uint32_t* axes) {
  for (const Direction& direction : directions) {
    if (direction.known > std::max(threshold, kNamed * direction.noise)) continue;
    for (int axis = first; axis < first + 3; ++axis) {
      if (std::abs(direction.motion[axis]) > kShareOfAxis) *axes |= 1u << axis;
    }
  }
  return directions[0].known;
}

}  // namespace

Degeneracy find_degeneracy(const Matrix6& information, const Matrix6& noise) {
  Degeneracy result;
  result.weakest_translation =
      examine(directions_of(information, noise, 0), kWeakTranslation, 0, &result.axes);
  result.weakest_rotation = examine(directions_of(information, noise, 3), kWeakRotation, 3, &result.axes);
  return result;
}

}  // namespace scanlock
