// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/surface_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr int kFitRounds = 12, kFewestToFit = 8;
constexpr double kNarrower = 0.1, kNarrowest = 0.35;  // epsilons: decrease of the scale per round, the least
constexpr double kReachAlong = 2;                     // scales, along the normal
constexpr double kReachWithin = 4;                    // epsilons
constexpr double kFirstWithin = 0.02, kLeastWithin = 0.01;
constexpr double kStill = 1e-5;  // metres, radians

/// Spread of the matches along the normals and within the surfaces.
struct Spread {
  double along = 0, within = 0;  // sums of squares of one axis

  void add(double weight, double squared_along, double squared_within) {
    along += weight * squared_along;
    within += weight * squared_within / 2;
  }
  /// Weight of an error within the surface relative to one along the normal: near 0 on walls, near 1 on
  /// bushes.
  double weight_within() const { return std::clamp(along / std::max(within, 1e-12), kLeastWithin, 1.0); }
};

/// Weighted normal equations of a translation and a rotation angle.
struct Equations {
  Eigen::Matrix4d h = Eigen::Matrix4d::Zero();
  Eigen::Vector4d g = Eigen::Vector4d::Zero();
  int count = 0;

  /// `offset`: residual, metres, weighted by `metric`; `turned`: derivative of the point by the angle.
  void add(const Eigen::Matrix3d& metric, const Eigen::Vector3d& turned, const Eigen::Vector3d& offset) {
    Eigen::Matrix<double, 3, 4> j;
    j << Eigen::Matrix3d::Identity(), turned;
    h += j.transpose() * metric * j;
    g += j.transpose() * metric * offset;
    ++count;
  }
};

}  // namespace

Pose fit_surfaces(const std::vector<SurfaceMatch>& matches, Pose pose, const Eigen::Vector3d& centre,
                  double epsilon) {
  const Eigen::Vector3d axis = pose.linear().col(2);
  const double two_variances = 2 * epsilon * epsilon;
  double weight_within = kFirstWithin;
  for (int round = 0; round < kFitRounds; ++round) {
    const double scale = std::max(kNarrowest, 1 - kNarrower * round) * epsilon;
    const Eigen::Vector3d middle = pose * centre;
    Equations equations;
    Spread spread;
    for (const SurfaceMatch& m : matches) {
      const Eigen::Vector3d at = pose * m.p, offset = at - m.q;
      const double along = m.normal_q.dot(offset);
      const double squared_within = offset.squaredNorm() - along * along;
      if (std::abs(along) > kReachAlong * scale ||
          squared_within > kReachWithin * kReachWithin * epsilon * epsilon ||
          std::abs(m.normal_q.dot(pose.linear() * m.normal_p)) < kSameWay)
        continue;
      // Welsch's weights, because matches that are near by chance are spread over the whole range.
      const double weight = exp(-along * along / (2 * scale * scale));
      if (squared_within < epsilon * epsilon) spread.add(weight, along * along, squared_within);
      const double within = weight_within * exp(-squared_within / two_variances);
      const Eigen::Matrix3d metric = weight * (m.normal_q * m.normal_q.transpose() * (1 - within) +
                                               within * Eigen::Matrix3d::Identity());
      equations.add(metric, axis.cross(at - middle), offset);
    }
    if (equations.count < kFewestToFit) break;
    const Eigen::Vector4d step = -equations.h.ldlt().solve(equations.g);
    if (!step.allFinite()) break;
    const Eigen::Matrix3d turn = so3_exp(axis * step[3]);
    pose.translation() = middle + step.head<3>() + turn * (pose.translation() - middle);
    pose.linear() = turn * pose.linear();
    weight_within = spread.weight_within();
    if (step.norm() < kStill) break;
  }
  return pose;
}

}  // namespace scanlock
