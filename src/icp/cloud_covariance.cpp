// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/cloud_covariance.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/linear.hpp"
#include "geometry/voxel_grid.hpp"
#include "icp/local_surfaces.hpp"
#include "icp/welsch.hpp"

namespace scanlock {
namespace {

constexpr std::size_t kSamples = 2048;
constexpr double kSigmaOfMedian = 1.4826;  // sigma over median absolute residual, normal distribution
constexpr double kReach = 3.0;             // sigmas: larger residuals do not count for the degeneracy
constexpr double kRadius = 5.0;            // spacings, at least; for normals of targets without normals
// Factor for errors that independent noise does not model (pairs across edges, pairs that change with the
// motion), from trials with known truth.
constexpr double kInflation = 5.0;
constexpr double kLeastSlope = 0.02;
// Sizes of the neighbourhoods within which errors may be correlated, as shares of the cloud's rms radius.
constexpr double kNeighbourhoods[] = {1.0 / 32, 1.0 / 16, 1.0 / 8, 1.0 / 4, 1.0 / 2};
// Standard deviation of a rotation that no pair observes: half a turn. Of a translation: the target's
// diagonal.
constexpr double kOpenRotation = kPi;

struct PlanePair {
  Vector6 j;  // derivative of the residual by xi, for the centred source
  Eigen::Vector3d p;
  double residual;
  std::int32_t target;
};

std::vector<PlanePair> plane_pairs(const PointCloud& source, const CloudTarget& target,
                                   const CloudProblem& problem, double gate) {
  std::vector<PlanePair> pairs;
  const std::size_t stride = std::max<std::size_t>(1, source.size() / kSamples);
  const Pose& pose = problem.pose();
  LocalSurfaces surfaces;
  const PointCloud& to = target.points();
  if (!target.normals_ready()) {
    surfaces.reset(
        to, target.tree(),
        static_cast<float>(std::max({kRadius * target.spacing(), gate, 1e-6 * target.diagonal()})));
    std::vector<std::int32_t> wanted;
    for (std::size_t i = 0; i < source.size(); i += stride) wanted.push_back(problem.pair(i).target);
    surfaces.prepare(wanted, 1);
  }
  for (std::size_t i = 0; i < source.size(); i += stride) {
    const CloudProblem::Pair found = problem.pair(i);
    if (found.target < 0 || !(found.squared_distance <= gate * gate)) continue;
    const std::size_t q = static_cast<std::size_t>(found.target);
    const Eigen::Vector3f normal = target.normals_ready() ? to.normal(q) : surfaces.at(found.target).normal;
    if (normal.isZero(0)) continue;
    const Eigen::Vector3d p = source.point(i).cast<double>(), n = normal.cast<double>();
    const Eigen::Vector3d body_normal = pose.linear().transpose() * n;
    PlanePair pair;
    pair.j << body_normal, p.cross(body_normal);
    pair.p = p;
    pair.residual = n.dot(pose * p - to.point(q).cast<double>());
    pair.target = found.target;
    pairs.push_back(pair);
  }
  return pairs;
}

double deviation(const std::vector<PlanePair>& pairs) {
  std::vector<double> values;
  for (const PlanePair& pair : pairs) values.push_back(std::abs(pair.residual));
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return kSigmaOfMedian * *middle;
}

/// Variance of a residual with which least squares would have the same covariance: b / a^2.
double effective_variance(const std::vector<PlanePair>& pairs, double nu) {
  double slope = 0, square = 0;
  for (const PlanePair& pair : pairs) {
    const double s = pair.residual * pair.residual;
    const double w = nu > 0 ? welsch_weight(s, nu) : 1.0;
    slope += nu > 0 ? w * (1.0 - s / (nu * nu)) : 1.0;
    square += w * w * s;
  }
  const double n = static_cast<double>(pairs.size());
  slope = std::max(slope / n, kLeastSlope);
  return square / n / (slope * slope);
}

/// Factor by which shared target points increase the variance: half of a residual's noise is that of the
/// target point.
double sharing(const std::vector<PlanePair>& pairs) {
  std::vector<std::int32_t> targets;
  for (const PlanePair& pair : pairs) targets.push_back(pair.target);
  std::sort(targets.begin(), targets.end());
  const auto distinct = std::unique(targets.begin(), targets.end()) - targets.begin();
  return 0.5 * (1.0 + static_cast<double>(pairs.size()) / static_cast<double>(distinct));
}

/// Factor by which errors that neighbours share increase the variance: the scatter of the gradients summed
/// over neighbourhoods of one size, over the scatter that independent errors would have. The largest factor
/// of several sizes is taken: small neighbourhoods miss errors with a longer correlation length, and very
/// large ones show none, because the sum over all pairs is 0.
double correlation(const std::vector<PlanePair>& pairs, const Matrix6& information, double nu) {
  double radius = 0, independent = 0, worst = 1;
  for (const PlanePair& pair : pairs) radius += pair.p.squaredNorm();
  radius = std::sqrt(radius / static_cast<double>(pairs.size()));
  const Eigen::LDLT<Matrix6> solver(information);
  const auto gradient = [&](const PlanePair& pair) -> Vector6 {
    const double s = pair.residual * pair.residual;
    return (nu > 0 ? welsch_weight(s, nu) : 1.0) * pair.residual * pair.j;
  };
  for (const PlanePair& pair : pairs) independent += gradient(pair).dot(solver.solve(gradient(pair)));
  if (!(radius > 0 && independent > 0)) return worst;
  std::vector<std::pair<std::uint64_t, std::size_t>> order(pairs.size());
  for (const double share : kNeighbourhoods) {
    const auto cell = [&](double v) { return static_cast<std::int32_t>(std::floor(v / (share * radius))); };
    for (std::size_t i = 0; i < pairs.size(); ++i)
      order[i] = {morton_key(cell(pairs[i].p.x()), cell(pairs[i].p.y()), cell(pairs[i].p.z())), i};
    std::sort(order.begin(), order.end());
    double together = 0;
    for (std::size_t i = 0; i < order.size();) {
      Vector6 sum = Vector6::Zero();
      const std::uint64_t key = order[i].first;
      for (; i < order.size() && order[i].first == key; ++i) sum += gradient(pairs[order[i].second]);
      together += sum.dot(solver.solve(sum));
    }
    worst = std::max(worst, together / independent);
  }
  return worst;
}

}  // namespace

AlignmentCertainty alignment_certainty(const PointCloud& source, const CloudTarget& target,
                                       const CloudProblem& problem, double gate, double nu,
                                       const Eigen::Vector3d& source_centre) {
  AlignmentCertainty certainty;
  const std::vector<PlanePair> pairs = plane_pairs(source, target, problem, gate);
  Matrix6 geometry = Matrix6::Zero(), information = Matrix6::Zero();
  if (!pairs.empty()) {
    const double rounding = 1e-7 * target.diagonal() + 1e-12;
    const double sigma = std::max(deviation(pairs), rounding);
    for (const PlanePair& pair : pairs) {
      const Matrix6 jj = pair.j * pair.j.transpose();
      information += jj;
      if (std::abs(pair.residual) <= kReach * sigma) geometry += jj;
    }
    const double variance = std::max(effective_variance(pairs, nu), rounding * rounding);
    const Matrix6 regular = information + 1e-12 * (information.trace() + 1e-300) * Matrix6::Identity();
    information /= kInflation * variance * std::max(sharing(pairs), correlation(pairs, regular, nu));
  }
  certainty.degeneracy = find_degeneracy(geometry);
  const double open = std::max(target.diagonal(), 1e-6);
  information.diagonal().head<3>().array() += 1.0 / (open * open);
  information.diagonal().tail<3>().array() += 1.0 / (kOpenRotation * kOpenRotation);
  const SymmetricEigen<6> eigen = symmetric_eigen(information);
  const Matrix6 centred_covariance =
      eigen.vectors * eigen.values.cwiseMax(1e-12).cwiseInverse().asDiagonal() * eigen.vectors.transpose();
  // In T exp(xi) with T = T_centred shift^-1, the adjoint of the shift from the centre to the cloud's origin
  // transforms xi.
  Pose own_from_centred = Pose::Identity();
  own_from_centred.translation() = source_centre;
  const Matrix6 shift = adjoint(own_from_centred);
  certainty.covariance = shift * centred_covariance * shift.transpose();
  return certainty;
}

}  // namespace scanlock
