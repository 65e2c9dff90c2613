// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/cloud_start.hpp"

#include <algorithm>

#include "icp/cloud_selection.hpp"
#include "icp/welsch.hpp"

namespace scanlock {
namespace {

constexpr double kNuMaxOfMedian = 3.0;  // section 4.3
constexpr std::size_t kRulePoints = 256, kApproachPoints = 512, kEvenPoints = 1024;
constexpr double kApproachTolerance = 0.02;  // of nu
constexpr double kApproachEnd = 0.7;         // spacings
constexpr double kOffShare = 0.33, kOffSpacings = 2.0, kMostlyOff = 0.5;

void count_searches(const CloudProblem& problem, CloudStart* start) {
  start->searches_made += problem.correspondences().searches_made();
  start->searches_saved += problem.correspondences().searches_saved();
}

/// Descends from `pose` at nu_max, nu_max / 2, ... as long as these are above `end`; all in metres.
Pose graduate(const Pose& pose, double nu_max, double end, CloudProblem* problem, CloudStart* sum) {
  if (!(nu_max > end)) return pose;
  double nu_min = nu_max;
  while (0.5 * nu_min > end) nu_min *= 0.5;
  const auto begin = [&](const Pose& at, double nu) { return problem->begin(at, nu, kWelschReach * nu); };
  const DescentResult found =
      robust_icp(*problem, begin(pose, nu_max), nu_max, nu_min, [&](const StateVector& x, double nu, bool) {
        DescentOptions descent;
        descent.max_iterations = 100;
        descent.max_line_search_steps = 0;
        descent.tolerance = kApproachTolerance * nu;
        return NuLevel{nu == nu_max ? x : begin(problem->pose(), nu), descent};
      });
  sum->iterations += found.iterations;
  sum->sweeps += found.evaluations;
  return problem->pose();
}

/// Mean of Welsch's function over the points: about the share of points that lie off the target.
double off_target(CloudProblem* problem, const Pose& pose, double nu) {
  return problem->evaluate(problem->begin(pose, nu, kWelschReach * nu)) /
         static_cast<double>(problem->used());
}

}  // namespace

double nu_max_at(const CentredCloud& source, const CloudTarget& target, const Pose& pose,
                 CloudProblem* problem) {
  problem->evaluate(problem->begin(pose, 1.0, open_gate(source, target, pose)));
  return kNuMaxOfMedian * problem->median_residual(kMedianPoints);
}

CloudStart approach(const CentredCloud& source, const CloudTarget& target, CloudProblem::Setup setup,
                    const Pose& guess) {
  CloudStart start;
  const CloudTarget coarse(spread_out(target.points(), target.diagonal(), 2 * kApproachPoints));
  const PointCloud apart = spread_out(source.points, source.diagonal, kApproachPoints);
  setup.objective = IcpObjective::kPoint;
  setup.candidates = CloudProblem::kFewCandidates;
  CloudProblem problem(apart, coarse, setup), whole(apart, target, setup);
  {
    const PointCloud few = thinned(source.points, kRulePoints);
    CloudProblem rule(few, target, setup);
    start.nu_max = nu_max_at(source, target, guess, &rule);
  }
  const Pose shifted = translation_by(-coarse.centre()) * guess;
  const double end = kApproachEnd * coarse.spacing();
  const double nu_max = nu_max_at(source, target, shifted, &problem);
  const Pose one = translation_by(coarse.centre()) * graduate(shifted, nu_max, end, &problem, &start);
  count_searches(problem, &start);
  const double nu = std::max(kOffShare * end, kOffSpacings * target.spacing());
  const double one_off = off_target(&whole, one, nu);
  start.pose = one;
  if (one_off < kMostlyOff) return start;
  const PointCloud evenly = thinned(source.points, kEvenPoints);
  CloudProblem second(evenly, target, setup);
  const Pose two = graduate(guess, nu_max_at(source, target, guess, &second), nu, &second, &start);
  const bool better =
      off_target(&whole, two, nu) + off_target(&second, two, nu) < one_off + off_target(&second, one, nu);
  count_searches(whole, &start);
  count_searches(second, &start);
  if (better) start.pose = two;
  return start;
}

}  // namespace scanlock
