// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/cloud_alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "geometry/elementary.hpp"
#include "icp/cloud_covariance.hpp"
#include "icp/cloud_selection.hpp"
#include "icp/welsch.hpp"

namespace scanlock {
namespace {

constexpr double kNuMaxOfMedian = 3.0;  // section 4.3
constexpr double kNuFactor = 0.5;
constexpr double kTolerance = 1e-5;  // of the diagonal
constexpr std::size_t kRulePoints = 256, kApproachPoints = 512, kEvenPoints = 1024;
constexpr double kJudgeShare = 0.33, kJudgeSpacings = 2.0, kMostlyOff = 0.5;
constexpr double kApproachTolerance = 0.02;  // of nu
constexpr double kApproachEnd = 0.7;         // spacings
// Where two do not descend, more find next to nothing.
constexpr int kLineSearchSteps = 2;
constexpr int kFewCandidates = 3;
constexpr std::size_t kMedianPoints = 2048;
constexpr double kInlierSpacings = 2.0;
constexpr double kGateMargin = 2.0;   // spacings, on top of the reach of nu, for distances within planes
constexpr double kFirstGate = 6.0;    // median distances at the start
constexpr double kHonestPairs = 3.0;  // median distances of the pairs
constexpr double kFewInliers = 0.02;

/// How far a level is driven; tolerances are shares of its nu. Distances to points creep: stopped early, they
/// have not arrived. Distances to planes jump there.
struct Effort {
  double last_tolerance, upper_tolerance;
  double upper_share;  ///< of the points that halving at each level would give
  std::size_t least_points;
};
constexpr Effort kPointEffort = {0.0003, 0.008, 1.0, 1024};
constexpr Effort kPlaneEffort = {0.1, 0.1, 1.0, 1024};

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
              point ? Correspondences::kCandidates : kFewCandidates};
    effort_ = point ? kPointEffort : kPlaneEffort;
    tolerance_ = options.tolerance > 0 ? options.tolerance : kTolerance * target.diagonal();
  }

  CloudAlignment run(const Pose& start) {
    Pose pose = centred_pose(start);
    pose = method_.robust ? solve_robust(pose) : solve_squares(pose);
    result_.target_from_source = renormalised(shift(target_.centre()) * pose * shift(-source_.centre));
    return result_;
  }

  double misfit(const Pose& guess) const {
    CloudProblem problem(source_.points, target_, setup_);
    const Pose pose = centred_pose(guess);
    problem.evaluate(problem.begin(pose, 1.0, 2.0 * everything(pose)));
    return problem.median_residual(kMedianPoints);
  }

 private:
  Pose centred_pose(const Pose& pose) const {
    return shift(-target_.centre()) * pose * shift(source_.centre);
  }

  static Pose shift(const Eigen::Vector3d& by) {
    Pose pose = Pose::Identity();
    pose.translation() = by;
    return pose;
  }

  /// Farther than any pair of points can be.
  double everything(const Pose& pose) const {
    return pose.translation().norm() + source_.diagonal + target_.diagonal() + 1e-6;
  }

  /// Pairs farther apart do not count at a level. For distances to points that changes nothing: their weight
  /// is below rounding there. A plane reaches farther than the surface it stands for, so a point far away can
  /// lie on it by chance (the authors' code lets it, and slides along some scenes); the gate closes as nu
  /// does.
  double gate(double nu, double first_nu) const {
    if (method_.objective == IcpObjective::kPoint) return kWelschReach * nu;
    return std::max(first_gate_ * nu / first_nu, 3.0 * nu + kGateMargin * target_.spacing());
  }

  void account(const DescentResult& level) {
    result_.iterations += level.iterations;
    result_.sweeps += level.evaluations;
    result_.energy = level.energy;
    result_.stop_reason = level.converged ? "converged" : "iterations";
  }

  Pose solve_squares(const Pose& start) {
    CloudProblem problem(source_.points, target_, setup_);
    DescentOptions descent;
    descent.anderson_window = method_.accelerated ? AndersonAcceleration::kMaxWindow : 0;
    descent.max_iterations = options_.max_iterations > 0 ? options_.max_iterations : 1000;
    descent.max_line_search_steps = method_.objective == IcpObjective::kPoint ? 0 : kLineSearchSteps;
    descent.tolerance = tolerance_;
    report_progress(&descent, 0.0, 1.0);
    account(descend(problem, problem.begin(start, 1.0, 2.0 * everything(start)), descent));
    finish(problem);
    return problem.pose();
  }

  /// A descent that takes the share of the work from `begin` to `end` tells how far it has come: steps shrink
  /// by about the same factor each time.
  void report_progress(DescentOptions* descent, double begin, double end) const {
    if (!options_.progress) return;
    descent->step_length = [=, &report = options_.progress, tolerance = descent->tolerance,
                            first = 0.0](double step) mutable {
      first = std::max(first, step);
      const double share = step > tolerance ? log(first / step) / log(first / tolerance) : 1.0;
      report(begin + (end - begin) * std::clamp(share, 0.0, 1.0));
    };
  }

  /// The first levels need few points, but equally far apart: rows and rings of a scan, dense near the
  /// sensor, hold on to those of the other. They go by distances to points, whose basin is wide, down to a nu
  /// where the method itself takes over. Where most of the points then still lie off the target (little
  /// overlap, or clutter that fills the room and outweighs the surfaces), points chosen evenly over the
  /// source have a try too, and the better one goes on.
  Pose approach(const Pose& start) {
    const CloudTarget coarse(spread_out(target_.points(), target_.diagonal(), 2 * kApproachPoints));
    const PointCloud apart = spread_out(source_.points, source_.diagonal, kApproachPoints);
    CloudProblem::Setup setup = setup_;
    setup.objective = IcpObjective::kPoint;
    setup.candidates = kFewCandidates;
    CloudProblem problem(apart, coarse, setup), judge(apart, target_, setup);
    {
      const PointCloud few = thinned(source_.points, kRulePoints);
      CloudProblem rule(few, target_, setup);
      result_.nu_max = first_nu(start, &rule);
    }
    const Pose shifted = shift(-coarse.centre()) * start;
    const double last_nu = kApproachEnd * coarse.spacing();
    const Pose one =
        shift(coarse.centre()) * descend_levels(shifted, first_nu(shifted, &problem), last_nu, &problem);
    count_searches(problem);
    const double nu = std::max(kJudgeShare * last_nu, kJudgeSpacings * target_.spacing());
    const auto off = [nu](CloudProblem& of, const Pose& pose) {
      return of.evaluate(of.begin(pose, nu, kWelschReach * nu)) / static_cast<double>(of.used());
    };
    const double one_off = off(judge, one);
    if (one_off < kMostlyOff) return one;
    const PointCloud evenly = thinned(source_.points, kEvenPoints);
    CloudProblem second(evenly, target_, setup);
    const Pose two = descend_levels(start, first_nu(start, &second), nu, &second);
    const bool better = off(judge, two) + off(second, two) < one_off + off(second, one);
    count_searches(judge);
    count_searches(second);
    return better ? two : one;
  }

  /// Section 4.3.
  double first_nu(const Pose& pose, CloudProblem* problem) const {
    problem->evaluate(problem->begin(pose, 1.0, 2.0 * everything(pose)));
    return kNuMaxOfMedian * problem->median_residual(kMedianPoints);
  }

  Pose descend_levels(Pose pose, double nu, double last_nu, CloudProblem* problem) {
    DescentOptions descent;
    descent.max_iterations = 100;
    descent.max_line_search_steps = 0;
    for (; nu > last_nu; nu *= kNuFactor) {
      descent.tolerance = kApproachTolerance * nu;
      account(descend(*problem, problem->begin(pose, nu, kWelschReach * nu), descent));
      pose = problem->pose();
    }
    return pose;
  }

  /// Distances to planes, over all points, tell how good a pose is.
  StateVector begin_planes(const Pose& pose, CloudProblem* problem) const {
    const double nu = target_.point_nu_min();
    return problem->begin(pose, nu, 3.0 * nu + kGateMargin * target_.spacing());
  }

  /// From the start or where the problem arrived, whichever is nearer to the planes, down to where it rests
  /// on them.
  Pose rest_on_planes(const Pose& start, CloudProblem* problem) {
    const Pose arrived = problem->pose();
    problem->use_objective(IcpObjective::kPlane);
    const double off = problem->evaluate(begin_planes(arrived, problem));
    const bool start_is_better = problem->evaluate(begin_planes(start, problem)) < off;
    DescentOptions descent;
    descent.anderson_window = AndersonAcceleration::kMaxWindow;
    descent.max_iterations = options_.max_iterations > 0 ? options_.max_iterations : 100;
    descent.max_line_search_steps = kLineSearchSteps;
    descent.tolerance = std::min(tolerance_, kPlaneEffort.last_tolerance * target_.point_nu_min());
    account(descend(*problem, begin_planes(start_is_better ? start : arrived, problem), descent));
    finish(*problem);
    if (start_is_better && result_.stop_reason != "degenerate") result_.stop_reason = "start";
    return problem->pose();
  }

  Pose solve_robust(const Pose& start) {
    Pose pose = start;
    if (!options_.thorough && !(options_.nu_max > 0)) pose = approach(pose);
    CloudProblem problem(source_.points, target_, setup_);
    const double first_nu = choose_nu(pose, &problem);
    DescentOptions descent;
    descent.anderson_window = method_.accelerated ? AndersonAcceleration::kMaxWindow : 0;
    descent.max_iterations = options_.max_iterations > 0 ? options_.max_iterations : 100;
    descent.max_line_search_steps = method_.objective == IcpObjective::kPoint ? 0 : kLineSearchSteps;
    // What comes to rest on planes afterwards need not arrive by distances to points.
    const double last_tolerance = keeps_better_start_
                                      ? effort_.upper_tolerance * result_.nu_min
                                      : std::min(tolerance_, effort_.last_tolerance * result_.nu_min);
    const double levels = 1.0 + std::max(0.0, std::ceil(log2(first_nu / result_.nu_min)));
    double level = 0;
    for (double nu = first_nu; nu > result_.nu_min; nu *= kNuFactor, ++level) {
      problem.use_first(options_.thorough ? source_.points.size() : points_for(nu));
      descent.tolerance =
          options_.thorough ? last_tolerance : std::max(last_tolerance, effort_.upper_tolerance * nu);
      report_progress(&descent, level / levels, (level + 1) / levels);
      account(descend(problem, problem.begin(pose, nu, gate(nu, first_nu)), descent));
      pose = problem.pose();
    }
    problem.use_first(source_.points.size());
    descent.tolerance = last_tolerance;
    report_progress(&descent, level / levels, 1.0);
    account(descend(problem, problem.begin(pose, result_.nu_min, gate(result_.nu_min, first_nu)), descent));
    if (keeps_better_start_) return rest_on_planes(start, &problem);
    finish(problem);
    return problem.pose();
  }

  /// The upper levels only have to bring the lower ones into their basin: each gets half as many points as
  /// the next.
  std::size_t points_for(double nu) const {
    const double wanted =
        std::max(static_cast<double>(effort_.least_points),
                 effort_.upper_share * static_cast<double>(source_.points.size()) * result_.nu_min / nu);
    std::size_t stride = 1;
    while (static_cast<double>(source_.points.size()) / static_cast<double>(2 * stride) >= wanted)
      stride *= 2;
    return (source_.points.size() + stride - 1) / stride;
  }

  /// Returns the first nu of the method's own levels.
  double choose_nu(const Pose& pose, CloudProblem* problem) {
    const bool point = method_.objective == IcpObjective::kPoint;
    result_.nu_min = options_.nu_min > 0 ? options_.nu_min
                     : point             ? target_.point_nu_min()
                                         : target_.plane_nu_min();
    // The normals of a thinned cloud are good to its spacing; the paper's rule for planes asks more of them.
    if (options_.voxel > 0 && !(options_.nu_min > 0))
      result_.nu_min = std::max(result_.nu_min, target_.point_nu_min());
    double first_nu = options_.nu_max;
    if (!(first_nu > 0)) {
      problem->use_first(std::min(source_.points.size(), kMedianPoints));
      problem->evaluate(problem->begin(pose, 1.0, 2.0 * everything(pose)));
      first_gate_ = kFirstGate * problem->median_distance(kMedianPoints);
      first_nu = kNuMaxOfMedian * problem->median_residual(kMedianPoints);
    }
    first_nu = std::max(first_nu, result_.nu_min);
    if (!(result_.nu_max > 0)) result_.nu_max = first_nu;
    return first_nu;
  }

  void count_searches(const CloudProblem& problem) {
    result_.searches_made += problem.correspondences().searches_made();
    result_.searches_saved += problem.correspondences().searches_saved();
  }

  /// What the scene leaves open at a pose. The last level knows only pairs within its small reach, and of a
  /// scan most of those are near the sensor: this asks points that are equally far apart, of any distance.
  std::uint32_t open_axes(const Pose& pose) const {
    const PointCloud apart = spread_out(source_.points, source_.diagonal, kEvenPoints);
    CloudProblem::Setup setup = setup_;
    setup.objective = IcpObjective::kPoint;
    setup.robust = false;
    CloudProblem problem(apart, target_, setup);
    problem.evaluate(problem.begin(pose, 1.0, 2.0 * everything(pose)));
    const double honest = kHonestPairs * problem.median_distance(apart.size());
    return alignment_certainty(apart, target_, problem, honest, 0.0, source_.centre).degeneracy.axes;
  }

  /// What the last state says about the result.
  void finish(const CloudProblem& problem) {
    count_searches(problem);
    const double gate = kInlierSpacings * std::max(target_.spacing(), 3.0 * result_.nu_min);
    std::size_t inliers = 0;
    for (std::size_t i = 0; i < source_.points.size(); ++i)
      inliers += problem.squared_distance(i) <= gate * gate ? 1 : 0;
    result_.inlier_ratio = static_cast<double>(inliers) / static_cast<double>(source_.points.size());
    // Rings and rows make the spacing much smaller than the distance of honest pairs: those are asked, too.
    const double honest = std::max(gate, kHonestPairs * problem.median_distance(source_.points.size()));
    // Distances to points use planes less well than distances to planes: as if nu were below the noise.
    const double planes_nu = method_.robust ? result_.nu_min : 0.0;
    const AlignmentCertainty certainty =
        alignment_certainty(source_.points, target_, problem, honest, planes_nu, source_.centre);
    result_.covariance = certainty.covariance;
    result_.degenerate_axes = certainty.degeneracy.axes;
    if (result_.degenerate_axes != 0) result_.degenerate_axes = open_axes(problem.pose());
    if (result_.degenerate_axes != 0 || result_.inlier_ratio < kFewInliers)
      result_.stop_reason = "degenerate";
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
