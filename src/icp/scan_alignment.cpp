// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/scan_alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/elementary.hpp"
#include "icp/correspondences.hpp"
#include "icp/descent.hpp"
#include "icp/scan_motion.hpp"
#include "icp/welsch.hpp"

namespace scanlock {
namespace {

/// Sums over the points of one knot, in the frame of the prior's pose: j = [n; w x n].
struct KnotSums {
  Matrix6 jj = Matrix6::Zero();
  Vector6 jr = Vector6::Zero();
};

/// Residuals spread evenly over the kernel leave about none: the bound keeps what is divided by it finite.
constexpr double kLeastCurvature = 0.05;
/// The patch that alone holds a direction leaves no residual along it: the bound keeps what is divided
/// finite.
constexpr double kLeastLeft = 0.1;

}  // namespace

/// State x = [log(prior^-1 pose); (twist - prior twist) * T; acceleration * T^2 / 8], T the duration of the
/// scan: all in metres and radians. A scan without times shows no acceleration: its state ends before it.
struct ScanAligner::Workspace final : DescentProblem {
  // Inputs of the alignment under way; set by begin().
  const PointCloud* source = nullptr;
  const AlignmentTarget* target = nullptr;
  const MotionPrior* prior = nullptr;
  const ScanAlignmentOptions* options = nullptr;

  ScanMotion motion;
  Correspondences correspondences;
  double nu = 1.0;
  double duration = 0.1;  // seconds: makes a velocity a displacement
  double arm = 10.0;      // metres: makes a rotation the motion of a typical point
  Vector6 x = Vector6::Zero(), twist = Vector6::Zero(), acceleration = Vector6::Zero();
  Matrix18 held = Matrix18::Zero();       // information of the prior
  std::vector<float> wx, wy, wz;          // source in the target frame
  std::vector<float> residuals, weights;  // per source point; NaN and 0 without a surface
  std::vector<double> kernel;             // Welsch's weight of the residual, where there is a surface
  int matched = 0;

  void begin(const PointCloud& cloud, const AlignmentTarget& to, const MotionPrior& from,
             const ScanAlignmentOptions& with) {
    source = &cloud;
    target = &to;
    prior = &from;
    options = &with;
    const std::size_t n = cloud.size();
    motion.set_times(cloud.time);
    correspondences.reset(to.cloud, to.tree, n);
    for (std::vector<float>* values : {&wx, &wy, &wz, &residuals, &weights}) values->resize(n);
    kernel.resize(n);
    held.topLeftCorner<12, 12>() = prior->information;
    held.diagonal().tail<6>() = prior->acceleration_variance.cwiseInverse();
    duration =
        motion.still() ? 0.1 : std::max(motion.knot_time(ScanMotion::kKnots) - motion.knot_time(0), 1e-3);
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += cloud.point(i).norm();
    arm = n > 0 ? std::max(sum / static_cast<double>(n), 0.1) : 1.0;
  }

  int unknowns() const { return motion.still() ? 12 : 18; }

  double gate() const { return 3.0 * nu + options->gate_margin; }

  MovingPose moving(const StateVector& state) const {
    MovingPose result{prior->mean.pose * se3_exp(state.head<6>()),
                      prior->mean.twist + state.segment<6>(6) / duration, Vector6::Zero(), motion.middle()};
    if (!motion.still()) result.acceleration = state.tail<6>() * (8 / (duration * duration));
    return result;
  }

  double evaluate(const StateVector& state) override {
    x = state.head<6>();
    const MovingPose there = moving(state);
    twist = there.twist;
    acceleration = there.acceleration;
    motion.set_motion(twist, acceleration, there.middle_s);
    const Eigen::Matrix3f rotation = there.pose.linear().cast<float>();
    const Eigen::Vector3f translation = there.pose.translation().cast<float>();
    const std::size_t n = source->size();
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Vector3f w = rotation * motion.at_stamp(i, source->point(i)) + translation;
      wx[i] = w.x();
      wy[i] = w.y();
      wz[i] = w.z();
    }
    correspondences.update(wx, wy, wz, static_cast<float>(gate()), options->threads);
    target->surfaces.prepare(correspondences.indices(), options->threads);
    return measure();
  }

  /// Residuals at the current correspondences, and the energy.
  double measure() {
    const float squared_gate = static_cast<float>(gate() * gate());
    const PointCloud& cloud = target->cloud;
    const std::vector<std::int32_t>& indices = correspondences.indices();
    double explained = 0;
    matched = 0;
    for (std::size_t i = 0; i < source->size(); ++i) {
      residuals[i] = std::numeric_limits<float>::quiet_NaN();
      weights[i] = 0;
      if (indices[i] < 0) continue;
      const std::size_t q = static_cast<std::size_t>(indices[i]);
      const float dx = wx[i] - cloud.x[q], dy = wy[i] - cloud.y[q], dz = wz[i] - cloud.z[q];
      const Surface& surface = target->surfaces.at(indices[i]);
      if (surface.weight <= 0 || dx * dx + dy * dy + dz * dz > squared_gate) continue;
      const Eigen::Vector3f off = Eigen::Vector3f(wx[i], wy[i], wz[i]) - surface.centre;
      const float along = surface.normal.dot(off);
      const float r = surface.line ? surface.scale * (off - along * surface.normal).norm() : along;
      residuals[i] = r;
      weights[i] = surface.weight;
      kernel[i] = welsch_weight(static_cast<double>(r) * r, nu);
      explained += surface.weight * kernel[i];
      ++matched;
    }
    const Vector18 e = prior_error();
    return static_cast<double>(source->size()) - explained + prior_share() * prior_cost(e.dot(held * e));
  }

  /// Of the prior against a weight of 1 a source point. It does not change with nu: at the upper scales
  /// residuals are not noise but misalignment, and a direction that the scene hardly fixes would slide before
  /// the others have settled.
  double prior_share() const { return options->sigma * options->sigma / (options->nu_min * options->nu_min); }

  Vector18 prior_error() const {
    Vector18 e;
    e << x, twist - prior->mean.twist, acceleration;
    return e;
  }

  /// A residual of a point: of a plane its distance, of a line the two components of it.
  struct Row {
    std::size_t point;
    int knot;            // of its time
    Vector6 j;           // derivative by [d; eta] at that time, in the frame of the prior's pose
    double residual;     // metres
    double weight;       // of the surface
    double along = 1.0;  // share of the distance that this component is: of a line 1 and 0
  };

  template <typename Visit>
  void visit_rows(const Visit& visit) const {
    const Eigen::Matrix3f to_prior = prior->mean.pose.linear().transpose().cast<float>();
    const Eigen::Vector3f origin = prior->mean.pose.translation().cast<float>();
    for (std::size_t i = 0; i < source->size(); ++i) {
      if (weights[i] <= 0) continue;
      const Surface& surface = target->surfaces.at(correspondences.indices()[i]);
      const Eigen::Vector3f world(wx[i], wy[i], wz[i]), w = to_prior * (world - origin);
      const auto add = [&](const Eigen::Vector3f& direction, double residual, double along) {
        const Eigen::Vector3f normal = to_prior * direction;
        Row row{i, motion.nearest_knot(i), Vector6(), residual, weights[i], along};
        row.j << normal.cast<double>(), w.cross(normal).cast<double>();
        visit(row);
      };
      if (surface.line) {
        const Eigen::Vector3f off = surface.scale * (world - surface.centre);
        const Eigen::Vector3f across = off - surface.normal.dot(off) * surface.normal;
        const float distance = across.norm();
        const Eigen::Vector3f a =
            distance > 0 ? Eigen::Vector3f(across / distance) : surface.normal.unitOrthogonal();
        add(surface.scale * a, distance, 1.0);
        add(surface.scale * surface.normal.cross(a), 0.0, 0.0);
      } else {
        add(surface.normal, residuals[i], 1.0);
      }
    }
  }

  /// Of a point at the time of a knot: [d; eta] moves it as basis * [d; eta] would at the stamp.
  Eigen::Matrix<double, 6, 18> basis_of(int knot) const {
    Eigen::Matrix<double, 6, 18> basis;
    const double time = motion.still() ? 0.0 : motion.knot_time(knot);
    const double bend = bend_at(time, motion.middle());
    const Matrix6 turned = adjoint(se3_exp(x)) * se3_left_jacobian(time * twist + bend * acceleration);
    basis << Matrix6::Identity(), time * turned, bend * turned;
    return basis;
  }

  using AllKnots = std::array<KnotSums, ScanMotion::kKnots + 1>;

  static void add(const Row& row, double weight, AllKnots* sums) {
    KnotSums& sum = (*sums)[static_cast<std::size_t>(row.knot)];
    sum.jj.selfadjointView<Eigen::Lower>().rankUpdate(row.j, weight);
    sum.jr += weight * row.residual * row.j;
  }

  void sum_up(const AllKnots& sums, Matrix18* hessian, Vector18* gradient) const {
    hessian->setZero();
    gradient->setZero();
    for (int k = 0; k <= ScanMotion::kKnots; ++k) {
      const KnotSums& sum = sums[static_cast<std::size_t>(k)];
      if (sum.jj.isZero(0)) continue;
      const Matrix6 jj = sum.jj.selfadjointView<Eigen::Lower>();
      const Eigen::Matrix<double, 6, 18> basis = basis_of(k);
      *hessian += basis.transpose() * jj * basis;
      *gradient += basis.transpose() * sum.jr;
    }
  }

  /// Gauss-Newton sums of the data: H = sum s w j j^T, g = sum s w r j, with j the derivative of r by
  /// [d; eta]: pose <- prior * exp(d) * exp(x), twist <- twist + eta,
  /// acceleration <- acceleration + the last six.
  void linearise(bool robust, Matrix18* hessian, Vector18* gradient) const {
    AllKnots sums{};
    visit_rows([&](const Row& row) { add(row, row.weight * (robust ? kernel[row.point] : 1.0), &sums); });
    sum_up(sums, hessian, gradient);
  }

  /// The second derivative of Welsch's function, w (1 - r^2 / nu^2) along a residual and w across it, over w.
  double curvature() const {
    double bent = 0, straight = 0;
    visit_rows([&](const Row& row) {
      const double weight = row.weight * kernel[row.point], r = residuals[row.point] / nu;
      bent += weight * (1.0 - row.along * r * r);
      straight += weight;
    });
    return straight > 0 ? std::max(bent / straight, kLeastCurvature) : 1.0;
  }

  /// Sum of g g^T / (1 - h) over the patches of the scene, g the sum of w r j of the points in it. A patch
  /// draws the pose to itself by its leverage h, its share of `hessian` (that of data and prior) along the
  /// step that g asks for, which makes its squared residuals smaller by 1 - h (HC2 of MacKinnon and White,
  /// 1985).
  Matrix18 scatter(const Matrix18& hessian) const {
    std::vector<Eigen::Matrix<double, 6, 18>> bases;
    for (int k = 0; k <= ScanMotion::kKnots; ++k) bases.push_back(basis_of(k));
    struct Derivative {
      double weight, residual;
      Vector18 j;
    };
    std::vector<Derivative> rows;
    std::vector<std::pair<std::uint64_t, std::size_t>> parts;  // patch, row
    rows.reserve(source->size());
    parts.reserve(source->size());
    visit_rows([&](const Row& row) {
      parts.emplace_back(patch_of(row.point), rows.size());
      rows.push_back({row.weight * kernel[row.point], row.along * row.residual,
                      bases[static_cast<std::size_t>(row.knot)].transpose() * row.j});
    });
    std::sort(parts.begin(), parts.end());
    const Matrix18 spread = inverse(hessian);
    Matrix18 scatter = Matrix18::Zero();
    for (std::size_t begin = 0, end = 0; begin < parts.size(); begin = end) {
      Vector18 gradient = Vector18::Zero();
      for (; end < parts.size() && parts[end].first == parts[begin].first; ++end) {
        const Derivative& row = rows[parts[end].second];
        gradient += row.weight * row.residual * row.j;
      }
      const Vector18 step = spread * gradient;
      double own = 0;
      for (std::size_t i = begin; i < end; ++i) {
        const Derivative& row = rows[parts[i].second];
        const double moved = row.j.dot(step);
        own += row.weight * moved * moved;
      }
      const double all = gradient.dot(step);
      const double leverage = all > 0 ? own / all : 0.0;
      scatter.selfadjointView<Eigen::Lower>().rankUpdate(gradient,
                                                         1.0 / std::max(1.0 - leverage, kLeastLeft));
    }
    return scatter.selfadjointView<Eigen::Lower>();
  }

  std::uint64_t patch_of(std::size_t i) const {
    const auto cell = [&](float metres) {
      const double cells = std::floor(static_cast<double>(metres) / options->patch);
      return static_cast<std::uint64_t>(std::clamp(cells, -1e6, 1e6) + 1e6);
    };
    return cell(wx[i]) << 42 | cell(wy[i]) << 21 | cell(wz[i]);
  }

  /// What errors of the surfaces' normals alone put into the sum of w j j^T, as expected.
  Matrix6 noise() const {
    Matrix6 result = Matrix6::Zero();
    const Eigen::Matrix3f to_prior = prior->mean.pose.linear().transpose().cast<float>();
    const Eigen::Vector3f origin = prior->mean.pose.translation().cast<float>();
    for (std::size_t i = 0; i < source->size(); ++i) {
      if (weights[i] <= 0) continue;
      const Surface& surface = target->surfaces.at(correspondences.indices()[i]);
      if (surface.line) continue;
      const double weight = weights[i] * kernel[i];
      const Eigen::Vector3f w = to_prior * (Eigen::Vector3f(wx[i], wy[i], wz[i]) - origin);
      const Eigen::Vector3f across = surface.tilt_across * surface.normal.cross(surface.tilt).normalized();
      for (const Eigen::Vector3f& tilt : {surface.tilt, across}) {
        const Eigen::Vector3f error = to_prior * tilt;
        Vector6 j;
        j << error.cast<double>(), w.cross(error).cast<double>();
        result.selfadjointView<Eigen::Lower>().rankUpdate(j, weight);
      }
    }
    return result.selfadjointView<Eigen::Lower>();
  }

  /// Information and scatter of pose and twist: the acceleration is solved along, and what is not known of it
  /// is known less of them.
  void tell(ScanAlignment* result) const {
    Matrix18 all;
    Vector18 gradient;
    linearise(true, &all, &gradient);
    const double variance = options->sigma * options->sigma;
    const Matrix6 expected = variance * held.bottomRightCorner<6, 6>();
    Eigen::Matrix<double, 12, 18> along = Eigen::Matrix<double, 12, 18>::Identity();
    along.rightCols<6>() =
        -all.topRightCorner<12, 6>() * inverse(Matrix6(all.bottomRightCorner<6, 6>() + expected));
    result->pose_information = all.topLeftCorner<6, 6>();
    result->information = all.topLeftCorner<12, 12>() + along.rightCols<6>() * all.bottomLeftCorner<6, 12>();
    // At the true acceleration the gradient of its prior is not zero either.
    Matrix18 scattered = scatter(all + variance * held);
    scattered.bottomRightCorner<6, 6>() += variance * expected;
    result->scatter = along * scattered * along.transpose();
  }

  StateVector image() override {
    Matrix18 hessian;
    Vector18 gradient;
    linearise(true, &hessian, &gradient);
    const Vector18 e = prior_error();
    const double scale = prior_share() * nu * nu * prior_weight(e.dot(held * e));
    // d moves x by J_l(x)^-1 d to first order.
    Matrix18 to_error = Matrix18::Identity();
    to_error.topLeftCorner<6, 6>() = inverse(se3_left_jacobian(x));
    hessian += scale * to_error.transpose() * held * to_error;
    gradient += scale * to_error.transpose() * (held * e);
    Vector18 step = Vector18::Zero();
    if (motion.still())
      step.head<12>() = -solve(Matrix12(hessian.topLeftCorner<12, 12>()), Vector12(gradient.head<12>()));
    else
      step = -solve(hessian, gradient);
    StateVector state(unknowns());
    state.head<6>() = se3_log(se3_exp(step.head<6>()) * se3_exp(x));
    state.segment<6>(6) = (twist - prior->mean.twist + step.segment<6>(6)) * duration;
    if (!motion.still()) state.tail<6>() = (acceleration + step.tail<6>()) * (0.125 * duration * duration);
    return state;
  }

  double distance(const StateVector& a, const StateVector& b) const override {
    const StateVector d = b - a;
    const double pose = d.head<3>().norm() + arm * d.segment<3>(3).norm();
    const double velocity = d.segment<3>(6).norm() + arm * d.segment<3>(9).norm();
    if (motion.still()) return pose;
    return pose + 0.5 * velocity + d.segment<3>(12).norm() + arm * d.segment<3>(15).norm();
  }

  double median_absolute_residual() const {
    std::vector<float> values;
    values.reserve(residuals.size());
    for (float r : residuals) {
      if (!std::isnan(r)) values.push_back(std::abs(r));
    }
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }
};

double prior_weight(double squared_error) {
  return (kPriorFreedom + 12.0) / (kPriorFreedom + squared_error);
}

double prior_cost(double squared_error) {
  return 0.5 * (kPriorFreedom + 12.0) * log1p(squared_error / kPriorFreedom);
}

ScanAligner::ScanAligner() : workspace_(std::make_unique<Workspace>()) {}
ScanAligner::~ScanAligner() = default;
ScanAligner::ScanAligner(ScanAligner&&) noexcept = default;
ScanAligner& ScanAligner::operator=(ScanAligner&&) noexcept = default;

ScanAlignment ScanAligner::align(const PointCloud& source, const AlignmentTarget& target,
                                 const MotionPrior& prior, const ScanAlignmentOptions& options) {
  Workspace& work = *workspace_;
  work.begin(source, target, prior, options);
  StateVector x = StateVector::Zero(work.unknowns());
  work.nu = options.nu_max;
  work.evaluate(x);
  // Section 5: the first scale is three times the median residual at the start. Where most points lie on the
  // ground, which fits anyhow, that says nothing of how far the others are off: nu_first does.
  work.nu = std::clamp(std::max(3.0 * work.median_absolute_residual(), options.nu_first), options.nu_min,
                       options.nu_max);

  ScanAlignment result;
  result.evaluations = 1;
  DescentOptions descent;
  descent.anderson_window = options.anderson_window;
  while (true) {
    const bool last = work.nu <= options.nu_min;
    // The upper scales only have to bring the lower ones into their basin.
    descent.max_iterations = last ? options.max_iterations : std::max(options.max_iterations / 3, 1);
    descent.tolerance = last ? options.tolerance : std::max(options.tolerance, 0.1 * work.nu);
    const DescentResult level = descend(work, x, descent);
    x = level.x;
    result.iterations += level.iterations;
    result.evaluations += level.evaluations;
    result.converged = level.converged;
    if (last) break;
    work.nu = std::max(0.5 * work.nu, options.nu_min);
  }
  work.tell(&result);
  result.noise = work.noise();
  result.curvature = work.curvature();
  result.sweep_s = work.motion.still() ? 0.0 : work.duration;
  result.moving = work.moving(x);
  result.matched = work.matched;
  result.median_residual = work.median_absolute_residual();
  result.searches_made = work.correspondences.searches_made();
  result.searches_saved = work.correspondences.searches_saved();
  return result;
}

const std::vector<float>& ScanAligner::residuals() const {
  return workspace_->residuals;
}
const std::vector<float>& ScanAligner::weights() const {
  return workspace_->weights;
}

std::vector<PointFit> ScanAligner::fits(const AlignmentTarget& target) const {
  const Workspace& work = *workspace_;
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
