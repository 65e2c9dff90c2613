// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/degeneracy.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/linear.hpp"

namespace scanlock {
namespace {

// Eigenvalues over trace: those of open fields are about as small.
constexpr double kWeakTranslation = 0.0045;
constexpr double kWeakRotation = 0.003;
// Least absolute component of a weak direction along a body axis that is reported as degenerate.
constexpr double kShareOfAxis = 0.5;

// Normals of neighbouring surfaces share their errors, so that the contribution of noise to H varies: in
// smooth tunnels it was half to three times the expected one.
constexpr double kMostNoise = 2.0;

Eigen::Matrix3d damped_inverse(const Eigen::Matrix3d& block) {
  return (block + Eigen::Matrix3d::Identity() * (1e-9 * block.trace() + 1e-300)).inverse();
}

/// An eigenvector of the information on translations, or on rotations.
struct Direction {
  Vector6 motion;       ///< unit in its own three components; the other three follow with least resistance
  double known, noise;  ///< information along the motion, and the contribution of noise to it
};

/// The three directions of translation (`first` = 0) or rotation (`first` = 3), in ascending order of
/// information.
std::array<Direction, 3> directions_of(const Matrix6& information, const Matrix6& noise, int first) {
  const int other = 3 - first;
  const Eigen::Matrix3d kept = information.block<3, 3>(first, first);
  const Eigen::Matrix3d follow =
      -damped_inverse(information.block<3, 3>(other, other)) * information.block<3, 3>(other, first);
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
    direction.known = trace * known[k];
    direction.noise = direction.motion.dot(noise * direction.motion);
  }
  return result;
}

/// The body axes along which a weak direction has a component above kShareOfAxis, as bits.
std::uint32_t axes_of(const Direction& direction, int first) {
  std::uint32_t axes = 0;
  for (int axis = first; axis < first + 3; ++axis) {
    if (std::abs(direction.motion[axis]) > kShareOfAxis) axes |= 1u << axis;
  }
  return axes;
}

}  // namespace

Degeneracy find_degeneracy(const Matrix6& information) {
  Degeneracy result;
  for (const int first : {0, 3}) {
    const double trace = std::max(information.block<3, 3>(first, first).trace(), 1e-300);
    const auto directions = directions_of(information, Matrix6::Zero(), first);
    (first == 0 ? result.weakest_translation : result.weakest_rotation) = directions[0].known / trace;
    for (const Direction& direction : directions) {
      if (direction.known / trace <= (first == 0 ? kWeakTranslation : kWeakRotation))
        result.axes |= axes_of(direction, first);
    }
  }
  return result;
}

Observed observed(const Matrix6& information, const Matrix6& noise, const Matrix6& predicted) {
  Observed result{Matrix6::Identity(), Matrix6::Identity()};
  for (const Direction& direction : directions_of(information, noise, 0)) {
    const Eigen::Vector3d own = direction.motion.head<3>();
    const double prior = 1.0 / own.dot(predicted.topLeftCorner<3, 3>() * own);
    const double all = std::max(direction.known, 1e-12 * prior);
    const double real = std::max(all - kMostNoise * direction.noise, 0.0);
    const double moved = real / (prior + real) * (prior + all) / all;
    result.motion.leftCols<3>() -= (1 - moved) * direction.motion * own.transpose();
    result.information.leftCols<3>() -= (1 - std::sqrt(real / all)) * direction.motion * own.transpose();
  }
  return result;
}

}  // namespace scanlock
