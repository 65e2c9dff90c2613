// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/cloud_outcome.hpp"

#include <algorithm>

#include "icp/cloud_covariance.hpp"
#include "icp/cloud_selection.hpp"

namespace scanlock {
namespace {

constexpr double kInlierSpacings = 2.0;
constexpr double kPairGate = 3.0;  // median distances of the pairs
constexpr double kFewInliers = 0.02;
constexpr std::size_t kOpenAxesPoints = 1024;

/// The axes that the scene does not constrain at a pose. At the last nu only pairs within its small reach
/// count, and in a scan most of these are near the sensor; this test therefore uses source points that are
/// equally far apart, and pairs up to kPairGate median distances.
std::uint32_t open_axes(const CentredCloud& source, const CloudTarget& target, CloudProblem::Setup setup,
                        const Pose& pose) {
  const PointCloud apart = spread_out(source.points, source.diagonal, kOpenAxesPoints);
  setup.objective = IcpObjective::kPoint;
  setup.robust = false;
  CloudProblem problem(apart, target, setup);
  problem.evaluate(problem.begin(pose, 1.0, open_gate(source, target, pose)));
  const double gate = kPairGate * problem.median_distance(apart.size());
  return alignment_certainty(apart, target, problem, gate, 0.0, source.centre).degeneracy.axes;
}

}  // namespace

CloudOutcome outcome_of(const CentredCloud& source, const CloudTarget& target, const CloudProblem& problem,
                        const CloudProblem::Setup& setup, double nu_min) {
  const std::size_t n = source.points.size();
  const double gate = kInlierSpacings * std::max(target.spacing(), 3.0 * nu_min);
  std::size_t inliers = 0;
  for (std::size_t i = 0; i < n; ++i) inliers += problem.squared_distance(i) <= gate * gate ? 1 : 0;
  // Rings and rows make the spacing much smaller than the distance of correct pairs: the gate is widened to
  // include these.
  const double pairs_gate = std::max(gate, kPairGate * problem.median_distance(n));
  // The point-to-point objective draws less information from planes than the point-to-plane objective. In the
  // covariance this is treated like a nu below the noise.
  const AlignmentCertainty certainty = alignment_certainty(source.points, target, problem, pairs_gate,
                                                           setup.robust ? nu_min : 0.0, source.centre);
  CloudOutcome outcome;
  outcome.inlier_ratio = static_cast<double>(inliers) / static_cast<double>(n);
  outcome.covariance = certainty.covariance;
  outcome.degenerate_axes = certainty.degeneracy.axes;
  if (outcome.degenerate_axes != 0)
    outcome.degenerate_axes = open_axes(source, target, setup, problem.pose());
  outcome.degenerate = outcome.degenerate_axes != 0 || outcome.inlier_ratio < kFewInliers;
  return outcome;
}

}  // namespace scanlock
