// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/degeneracy.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

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

Eigen::Matrix3d schur(const Eigen::Matrix3d& kept, const Eigen::Matrix3d& coupling,
                      const Eigen::Matrix3d& removed) {
  return kept - coupling * inverse(removed) * coupling.transpose();
}

double examine(const Eigen::Matrix3d& block, double trace, double threshold, int first_bit,
               std::uint32_t* axes) {
  if (!(trace > 0)) {
    *axes |= 7u << first_bit;
    return 0;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(block / trace);
  for (int k = 0; k < 3; ++k) {
    if (solver.eigenvalues()[k] > threshold) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(solver.eigenvectors()(axis, k)) > kShareOfAxis) *axes |= 1u << (first_bit + axis);
    }
  }
  return solver.eigenvalues()[0];
}

}  // namespace

Degeneracy find_degeneracy(const Matrix6& information) {
  const Eigen::Matrix3d tt = information.topLeftCorner<3, 3>(), rr = information.bottomRightCorner<3, 3>();
  const Eigen::Matrix3d tr = information.topRightCorner<3, 3>();
  Degeneracy result;
  result.weakest_translation = examine(schur(tt, tr, rr), tt.trace(), kWeakTranslation, 0, &result.axes);
  result.weakest_rotation =
      examine(schur(rr, tr.transpose(), tt), rr.trace(), kWeakRotation, 3, &result.axes);
  return result;
}

Matrix6 observed_motion(const Matrix6& information) {
  const Eigen::Matrix3d tt = information.topLeftCorner<3, 3>(), rr = information.bottomRightCorner<3, 3>();
  const Eigen::Matrix3d tr = information.topRightCorner<3, 3>();
  Matrix6 observed = Matrix6::Identity();
  if (!(tt.trace() > 0)) return observed;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(schur(tt, tr, rr) / tt.trace());
  Eigen::Matrix3d open = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d direction = solver.eigenvectors().col(k);
    const double seen = (solver.eigenvalues()[k] - kNoTranslation) / (kSomeTranslation - kNoTranslation);
    open += (1.0 - std::clamp(seen, 0.0, 1.0)) * direction * direction.transpose();
  }
  observed.topLeftCorner<3, 3>() -= open;
  observed.bottomLeftCorner<3, 3>() += inverse(rr) * tr.transpose() * open;
  return observed;
}

}  // namespace scanlock
