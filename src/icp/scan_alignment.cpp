// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/scan_alignment.hpp"

#include <algorithm>

#include "geometry/elementary.hpp"
#include "icp/scan_problem.hpp"

namespace scanlock {

double prior_weight(double squared_error) {
  return (kPriorFreedom + 12.0) / (kPriorFreedom + squared_error);
}

double prior_cost(double squared_error) {
  return 0.5 * (kPriorFreedom + 12.0) * log1p(squared_error / kPriorFreedom);
}

ScanAligner::ScanAligner() : problem_(std::make_unique<ScanProblem>()) {}
ScanAligner::~ScanAligner() = default;
ScanAligner::ScanAligner(ScanAligner&&) noexcept = default;
ScanAligner& ScanAligner::operator=(ScanAligner&&) noexcept = default;

ScanAlignment ScanAligner::align(const PointCloud& source, const AlignmentTarget& target,
                                 const MotionPrior& prior, const ScanAlignmentOptions& options) {
  ScanProblem& work = *problem_;
  work.begin(source, target, prior, options);
  const StateVector start = StateVector::Zero(work.unknowns());
  work.nu = options.nu_max;
  work.evaluate(start);
  // Section 5: the first scale is three times the median residual at the start. Where most points lie on the
  // ground, which fits at almost any pose, the median does not measure the error of the other points;
  // nu_first is a lower bound for these.
  const double nu_max = std::clamp(std::max(3.0 * work.median_absolute_residual(), options.nu_first),
                                   options.nu_min, options.nu_max);
  const DescentResult found =
      robust_icp(work, start, nu_max, options.nu_min, [&](const StateVector& x, double nu, bool last) {
        work.nu = nu;
        DescentOptions descent;
        descent.anderson_window = options.anderson_window;
        // A line search would stop where points of a scan that is distorted by a wrong velocity change their
        // correspondences, and the next prediction would use this wrong velocity.
        descent.max_line_search_steps = 0;
        descent.patience = 3;
        // The upper scales only have to reach the basin of convergence of the next lower scale.
        descent.max_iterations = last ? options.max_iterations : std::max(options.max_iterations / 3, 1);
        descent.tolerance = last ? options.tolerance : std::max(options.tolerance, 0.1 * nu);
        return NuLevel{x, descent};
      });

  ScanAlignment result;
  result.iterations = found.iterations;
  result.evaluations = 1 + found.evaluations;
  result.converged = found.converged;
  work.tell(&result);
  result.noise = work.noise();
  result.curvature = work.curvature();
  result.moving = work.moving(found.x);
  result.matched = work.matched;
  result.median_residual = work.median_absolute_residual();
  result.searches_made = work.correspondences.searches_made();
  result.searches_saved = work.correspondences.searches_saved();
  return result;
}

const std::vector<float>& ScanAligner::residuals() const {
  return problem_->residuals;
}
const std::vector<float>& ScanAligner::weights() const {
  return problem_->weights;
}
const std::vector<float>& ScanAligner::distances() const {
  return problem_->distances;
}

std::vector<PointFit> ScanAligner::fits(const AlignmentTarget& target) const {
  const ScanProblem& work = *problem_;
  std::vector<PointFit> fits(work.residuals.size());
  for (std::size_t i = 0; i < fits.size(); ++i) {
    fits[i].place = {work.wx[i], work.wy[i], work.wz[i]};
    if (work.weights[i] <= 0) continue;
    fits[i].surface = target.surfaces.at(work.correspondences.indices()[i]);
    fits[i].explained = static_cast<float>(work.weights[i] * work.kernel[i]);
  }
  return fits;
}

PointCloud deskewed(const PointCloud& points, const MovingPose& moving) {
  PointCloud result = points;
  ScanMotion motion;
  motion.set_times(points.time);
  if (motion.still()) return result;
  motion.set_motion(moving.twist, moving.acceleration, moving.middle_s);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p = motion.at_stamp(i, points.point(i));
    result.x[i] = p.x();
    result.y[i] = p.y();
    result.z[i] = p.z();
  }
  return result;
}

}  // namespace scanlock
