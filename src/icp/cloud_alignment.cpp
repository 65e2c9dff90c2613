// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/cloud_alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "geometry/elementary.hpp"
#include "icp/cloud_outcome.hpp"
#include "icp/cloud_selection.hpp"
#include "icp/cloud_start.hpp"
#include "icp/welsch.hpp"

namespace scanlock {
namespace {

constexpr double kTolerance = 1e-5;  // of the target's diagonal
// Where two shorter steps do not lower the energy, further ones hardly ever do.
constexpr int kLineSearchSteps = 2;
constexpr double kGateMargin = 2.0;  // spacings, added to the reach of nu for the distance within the plane
constexpr double kFirstGate = 6.0;   // median distances of the pairs at the start
constexpr double kLeastPoints = 1024;

/// Convergence tolerances, as shares of nu, at the last nu and at the upper ones. Point-to-point iterations
/// take many short steps, and a wide tolerance would stop them before the minimum; point-to-plane iterations
/// reach it in few long steps.
struct Effort {
  double last_tolerance, upper_tolerance;
};
constexpr Effort kPointEffort = {0.0003, 0.008};
constexpr Effort kPlaneEffort = {0.1, 0.1};

class CloudAligner {
 public:
  CloudAligner(const PointCloud& source, const CloudTarget& target, const CloudMethod& method,
               const CloudAlignmentOptions& options)
      : target_(target), method_(method), options_(options), source_(centred(source)) {
    if (source_.points.size() < 3) {
      throw std::invalid_argument(std::to_string(source_.points.size()) +
                                  " finite points; an alignment takes at least 3");
    }
    keeps_better_start_ =
        options.start_may_be_better && method.robust && method.objective == IcpObjective::kPoint;
    if ((method.needs_normals() || keeps_better_start_) && !target.normals_ready())
      throw std::invalid_argument("this method takes a target whose normals are prepared");
    if (method.objective == IcpObjective::kSymmetric) {
      KdForest tree;
      tree.rebuild(source_.points);
      estimate_normals(&source_.points, tree, CloudTarget::normal_neighbours(options.voxel), options.threads);
    }
    source_.points = in_level_order(source_.points);
    // Steps of plane methods are few and long, those of point methods many and short.
    const bool point = method.objective == IcpObjective::kPoint;
    setup_ = {method.objective, method.coordinates, method.robust, options.threads,
              point ? Correspondences::kCandidates : CloudProblem::kFewCandidates};
    effort_ = point ? kPointEffort : kPlaneEffort;
    tolerance_ = options.tolerance > 0 ? options.tolerance : kTolerance * target.diagonal();
  }

  CloudAlignment run(const Pose& start) {
    Pose pose = centred_pose(start);
    pose = method_.robust ? solve_robust(pose) : solve_squares(pose);
    result_.target_from_source =
        renormalised(translation_by(target_.centre()) * pose * translation_by(-source_.centre));
    return result_;
  }

  double misfit(const Pose& guess) const {
    CloudProblem problem(source_.points, target_, setup_);
    const Pose pose = centred_pose(guess);
    problem.evaluate(problem.begin(pose, 1.0, open_gate(source_, target_, pose)));
    return problem.median_residual(kMedianPoints);
  }

 private:
  Pose centred_pose(const Pose& pose) const {
    return translation_by(-target_.centre()) * pose * translation_by(source_.centre);
  }

  /// Metres: pairs farther apart do not count at the level of `nu`. For distances to points the gate changes
  /// nothing, since the weight beyond it is below rounding. A plane extends beyond the surface that it was
  /// fitted to, so that a distant point can lie on it by chance (the authors' code counts such pairs, and
  /// slides along some scenes); the gate therefore shrinks with nu.
  double gate(double nu, double nu_max) const {
    if (method_.objective == IcpObjective::kPoint) return kWelschReach * nu;
    return std::max(first_gate_ * nu / nu_max, 3.0 * nu + kGateMargin * target_.spacing());
  }

  DescentOptions descent_options() const {
    const bool point = method_.objective == IcpObjective::kPoint;
    DescentOptions descent;
    descent.anderson_window = method_.accelerated ? AndersonAcceleration::kMaxWindow : 0;
    descent.max_iterations = options_.max_iterations > 0 ? options_.max_iterations
                             : method_.robust            ? 100
                                                         : 1000;
    descent.max_line_search_steps = point ? 0 : kLineSearchSteps;
    return descent;
  }

  void account(const DescentResult& found) {
    result_.iterations += found.iterations;
    result_.sweeps += found.evaluations;
    result_.energy = found.energy;
    result_.stop_reason = found.converged ? "converged" : "iterations";
  }

  /// Problems (1) and (19): section 4.2.
  Pose solve_squares(const Pose& start) {
    CloudProblem problem(source_.points, target_, setup_);
    DescentOptions descent = descent_options();
    descent.tolerance = tolerance_;
    report_progress(&descent, 0.0, 1.0);
    account(descend(problem, problem.begin(start, 1.0, open_gate(source_, target_, start)), descent));
    finish(problem);
    return problem.pose();
  }

  /// Makes a descent report its progress, from `begin` to `end` as shares of the whole work. Its step lengths
  /// shrink by about the same factor each time, so that progress is the logarithm of the step length.
  void report_progress(DescentOptions* descent, double begin, double end) const {
    if (!options_.progress) return;
    descent->step_length = [=, &report = options_.progress, tolerance = descent->tolerance,
                            first = 0.0](double step) mutable {
      first = std::max(first, step);
      const double share = step > tolerance ? log(first / step) / log(first / tolerance) : 1.0;
      report(begin + (end - begin) * std::clamp(share, 0.0, 1.0));
    };
  }

  /// Problems (13) and (20): algorithms 1 and 2. The upper nu only have to reach the basin of convergence of
  /// the next lower nu: each uses half as many points as the next, and a wider tolerance.
  Pose solve_robust(const Pose& guess) {
    const Pose start = !options_.thorough && !(options_.nu_max > 0) ? begin_near(guess) : guess;
    CloudProblem problem(source_.points, target_, setup_);
    const double nu_min = result_.nu_min = choose_nu_min(), nu_max = choose_nu_max(start, &problem);
    // If the pose is refined on planes afterwards, the point-to-point descent need not converge fully.
    const double last_tolerance = keeps_better_start_ ? effort_.upper_tolerance * nu_min
                                                      : std::min(tolerance_, effort_.last_tolerance * nu_min);
    const double levels = 1.0 + std::max(0.0, std::ceil(log2(nu_max / nu_min)));
    double level = 0;
    const auto begin = [&](const Pose& pose, double nu) { return problem.begin(pose, nu, gate(nu, nu_max)); };
    account(robust_icp(
        problem, begin(start, nu_max), nu_max, nu_min, [&](const StateVector& x, double nu, bool last) {
          const std::size_t n = source_.points.size();
          const bool all = last || options_.thorough;
          const double wanted = static_cast<double>(n) * nu_min / nu;
          problem.use_first(all ? n : level_points(n, std::max(kLeastPoints, wanted)));
          DescentOptions descent = descent_options();
          descent.tolerance = all ? last_tolerance : std::max(last_tolerance, effort_.upper_tolerance * nu);
          report_progress(&descent, level / levels, last ? 1.0 : (level + 1) / levels);
          ++level;
          return NuLevel{nu == nu_max ? x : begin(problem.pose(), nu), descent};
        }));
    if (keeps_better_start_) return rest_on_planes(guess, &problem);
    finish(problem);
    return problem.pose();
  }

  Pose begin_near(const Pose& guess) {
    const CloudStart start = approach(source_, target_, setup_, guess);
    result_.nu_max = start.nu_max;
    result_.iterations += start.iterations;
    result_.sweeps += start.sweeps;
    result_.searches_made += start.searches_made;
    result_.searches_saved += start.searches_saved;
    return start.pose;
  }

  double choose_nu_min() const {
    if (options_.nu_min > 0) return options_.nu_min;
    const bool point = method_.objective == IcpObjective::kPoint;
    const double by_rule = point ? target_.point_nu_min() : target_.plane_nu_min();
    // The normals of a thinned cloud are accurate to its spacing only; the paper's rule for planes assumes
    // more accurate ones.
    return options_.voxel > 0 ? std::max(by_rule, target_.point_nu_min()) : by_rule;
  }

  double choose_nu_max(const Pose& start, CloudProblem* problem) {
    double nu_max = options_.nu_max;
    if (!(nu_max > 0)) {
      problem->use_first(std::min(source_.points.size(), kMedianPoints));
      nu_max = nu_max_at(source_, target_, start, problem);
      first_gate_ = kFirstGate * problem->median_distance(kMedianPoints);
    }
    nu_max = std::max(nu_max, result_.nu_min);
    if (!(result_.nu_max > 0)) result_.nu_max = nu_max;
    return nu_max;
  }

  /// The state of `pose` for distances to planes, over all points, whose energy compares poses.
  StateVector begin_planes(const Pose& pose, CloudProblem* problem) const {
    const double nu = target_.point_nu_min();
    return problem->begin(pose, nu, 3.0 * nu + kGateMargin * target_.spacing());
  }

  /// Minimises the distances to planes, from the start or from the pose that the problem reached, whichever
  /// has the lower energy.
  Pose rest_on_planes(const Pose& start, CloudProblem* problem) {
    const Pose arrived = problem->pose();
    problem->use_objective(IcpObjective::kPlane);
    const double off = problem->evaluate(begin_planes(arrived, problem));
    const bool start_is_better = problem->evaluate(begin_planes(start, problem)) < off;
    DescentOptions descent = descent_options();
    descent.anderson_window = AndersonAcceleration::kMaxWindow;
    descent.max_line_search_steps = kLineSearchSteps;
    descent.tolerance = std::min(tolerance_, kPlaneEffort.last_tolerance * target_.point_nu_min());
    account(descend(*problem, begin_planes(start_is_better ? start : arrived, problem), descent));
    finish(*problem);
    if (start_is_better && result_.stop_reason != "degenerate") result_.stop_reason = "start";
    return problem->pose();
  }

  void finish(const CloudProblem& problem) {
    result_.searches_made += problem.correspondences().searches_made();
    result_.searches_saved += problem.correspondences().searches_saved();
    const CloudOutcome outcome = outcome_of(source_, target_, problem, setup_, result_.nu_min);
    result_.inlier_ratio = outcome.inlier_ratio;
    result_.covariance = outcome.covariance;
    result_.degenerate_axes = outcome.degenerate_axes;
    if (outcome.degenerate) result_.stop_reason = "degenerate";
  }

  const CloudTarget& target_;
  CloudMethod method_;
  bool keeps_better_start_ = false;
  CloudAlignmentOptions options_;
  CentredCloud source_;
  CloudProblem::Setup setup_;
  Effort effort_ = kPointEffort;
  double tolerance_ = 0;
  double first_gate_ = 0;
  CloudAlignment result_;
};

struct NamedMethod {
  const char* name;
  CloudMethod method;
};
constexpr std::array<NamedMethod, 9> kMethods = {{
    {"icp", {IcpObjective::kPoint, false, false, MotionCoordinates::kLieAlgebra}},
    {"aa-icp", {IcpObjective::kPoint, false, true, MotionCoordinates::kEulerAngles}},
    {"fast-icp", {IcpObjective::kPoint, false, true, MotionCoordinates::kLieAlgebra}},
    {"robust-icp", {IcpObjective::kPoint, true, true, MotionCoordinates::kLieAlgebra}},
    {"icp-plane", {IcpObjective::kPlane, false, false, MotionCoordinates::kLieAlgebra}},
    {"fast-icp-plane", {IcpObjective::kPlane, false, true, MotionCoordinates::kLieAlgebra}},
    {"robust-icp-plane", {IcpObjective::kPlane, true, true, MotionCoordinates::kLieAlgebra}},
    {"symmetric-icp", {IcpObjective::kSymmetric, false, false, MotionCoordinates::kLieAlgebra}},
    {"robust-symmetric-icp", {IcpObjective::kSymmetric, true, true, MotionCoordinates::kLieAlgebra}},
}};

}  // namespace

std::optional<CloudMethod> find_cloud_method(const std::string& name) {
  for (const NamedMethod& entry : kMethods) {
    if (name == entry.name) return entry.method;
  }
  return std::nullopt;
}

std::vector<std::string> cloud_method_names() {
  std::vector<std::string> names;
  for (const NamedMethod& entry : kMethods) names.emplace_back(entry.name);
  return names;
}

CloudAlignment align_clouds(const PointCloud& source, const CloudTarget& target, const Pose& start,
                            const CloudMethod& method, const CloudAlignmentOptions& options) {
  return CloudAligner(source, target, method, options).run(start);
}

double misfit(const PointCloud& source, const CloudTarget& target, const Pose& guess) {
  return CloudAligner(thinned(source, kMedianPoints), target, {IcpObjective::kPoint}, {}).misfit(guess);
}

}  // namespace scanlock
