// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/degeneracy.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

namespace scanlock {
namespace {

// Noise of the normals alone makes a smooth tunnel look observed to about 0.002 (3 degrees squared).
constexpr double kWeakTranslation = 0.0045;
constexpr double kWeakRotation = 0.003;
// A weak direction is charged to the body axes that make up most of it.
constexpr double kShareOfAxis = 0.5;

// In smooth tunnels, where normals are all noise, it is 0.0003 to 0.0007; in open fields 0.0013 and more.
constexpr double kNoTranslation = 0.0010, kSomeTranslation = 0.0016;

Eigen::Matrix3d inverse(const Eigen::Matrix3d& block) {
  return (block + Eigen::Matrix3d::Identity() * (1e-9 * block.trace() + 1e-300)).inverse();
}

/// The blocks of an information matrix for three of its unknowns and the three others.
struct Blocks {
  Eigen::Matrix3d kept, coupling, removed;
};

Blocks translations_of(const Matrix6& information) {
  return {information.topLeftCorner<3, 3>(), information.topRightCorner<3, 3>(),
          information.bottomRightCorner<3, 3>()};
}

Blocks rotations_of(const Matrix6& information) {
  return {information.bottomRightCorner<3, 3>(), information.bottomLeftCorner<3, 3>(),
          information.topLeftCorner<3, 3>()};
}

/// Directions of the kept unknowns and what is known along each, over the block's trace; nothing where that
/// is 0.
std::optional<Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>> spectrum(const Blocks& blocks) {
  const double trace = blocks.kept.trace();
  if (!(trace > 0)) return std::nullopt;
  const Eigen::Matrix3d seen =
      blocks.kept - blocks.coupling * inverse(blocks.removed) * blocks.coupling.transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(seen / trace);
}

double examine(const Blocks& blocks, double threshold, int first_bit, std::uint32_t* axes) {
  const auto directions = spectrum(blocks);
  if (!directions) {
    *axes |= 7u << first_bit;
    return 0;
  }
  for (int k = 0; k < 3; ++k) {
    if (directions->eigenvalues()[k] > threshold) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(directions->eigenvectors()(axis, k)) > kShareOfAxis) *axes |= 1u << (first_bit + axis);
    }
  }
  return directions->eigenvalues()[0];
}

}  // namespace

Degeneracy find_degeneracy(const Matrix6& information) {
  Degeneracy result;
  result.weakest_translation = examine(translations_of(information), kWeakTranslation, 0, &result.axes);
  result.weakest_rotation = examine(rotations_of(information), kWeakRotation, 3, &result.axes);
  return result;
}

Matrix6 observed_motion(const Matrix6& information) {
  Matrix6 observed = Matrix6::Identity();
  const Blocks blocks = translations_of(information);
  const auto directions = spectrum(blocks);
  if (!directions) return observed;
  Eigen::Matrix3d open = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d direction = directions->eigenvectors().col(k);
    const double seen = (directions->eigenvalues()[k] - kNoTranslation) / (kSomeTranslation - kNoTranslation);
    open += (1.0 - std::clamp(seen, 0.0, 1.0)) * direction * direction.transpose();
  }
  observed.topLeftCorner<3, 3>() -= open;
  observed.bottomLeftCorner<3, 3>() += inverse(blocks.removed) * blocks.coupling.transpose() * open;
  return observed;
}

}  // namespace scanlock
