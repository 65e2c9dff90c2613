// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/scan_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "icp/welsch.hpp"

namespace scanlock {
namespace {

constexpr double kStraight = 1e-8;  // least variance of the acceleration, which holds it at zero

/// Sums over the points whose nearest knot is the same, in the frame of the prior's pose: j = [n; w x n].
struct KnotSums {
  Matrix6 jj = Matrix6::Zero();
  Vector6 jr = Vector6::Zero();
};

/// True if a ray from the sensor in the direction `to_eye` (metres) meets the unobserved side of a plane, by
/// more than two standard deviations of its normal: the two sides of a thin wall are different surfaces.
bool is_behind(const Surface& surface, const Eigen::Vector3f& to_eye) {
  const float towards = surface.normal.dot(to_eye);
  if (surface.line || towards >= 0) return false;  // nearly all points, so that few need the lines below
  const float error = std::sqrt(surface.tilt.squaredNorm() + surface.tilt_across * surface.tilt_across);
  return towards < -2 * error * to_eye.norm();
}

}  // namespace

void ScanProblem::begin(const PointCloud& cloud, const AlignmentTarget& to, const MotionPrior& from,
                        const ScanAlignmentOptions& with) {
  source = &cloud;
  target = &to;
  prior = &from;
  options = &with;
  const std::size_t n = cloud.size();
  motion.set_times(cloud.time);
  correspondences.reset(to.cloud, to.tree, n);
  for (std::vector<float>* values : {&wx, &wy, &wz, &distances, &residuals, &weights}) values->resize(n);
  kernel.resize(n);
  duration =
      motion.still() ? 0.1 : std::max(motion.knot_time(ScanMotion::kKnots) - motion.knot_time(0), 1e-3);
  held.topLeftCorner<12, 12>() = prior->information;
  held.diagonal().tail<6>() =
      (acceleration_variance(duration) * prior->acceleration_density).cwiseMax(kStraight).cwiseInverse();
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += cloud.point(i).norm();
  arm = n > 0 ? std::max(sum / static_cast<double>(n), 0.1) : 1.0;
}

MovingPose ScanProblem::moving(const StateVector& state) const {
  MovingPose result{prior->mean.pose * se3_exp(state.head<6>()),
                    prior->mean.twist + state.segment<6>(6) / duration, Vector6::Zero(), motion.middle()};
  if (!motion.still()) result.acceleration = state.tail<6>() * (8 / (duration * duration));
  return result;
}

double ScanProblem::evaluate(const StateVector& state) {
  x = state.head<6>();
  const MovingPose there = moving(state);
  twist = there.twist;
  acceleration = there.acceleration;
  motion.set_motion(twist, acceleration, there.middle_s);
  const Eigen::Matrix3f rotation = there.pose.linear().cast<float>();
  const Eigen::Vector3f translation = there.pose.translation().cast<float>();
  eye = translation;
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

double ScanProblem::measure() {
  const float squared_gate = static_cast<float>(gate() * gate());
  const PointCloud& cloud = target->cloud;
  const std::vector<std::int32_t>& indices = correspondences.indices();
  const bool sided = options->sided && cloud.has_viewpoints();
  double explained = 0;
  matched = 0;
  for (std::size_t i = 0; i < source->size(); ++i) {
    distances[i] = residuals[i] = std::numeric_limits<float>::quiet_NaN();
    weights[i] = 0;
    if (indices[i] < 0) continue;
    const std::size_t q = static_cast<std::size_t>(indices[i]);
    const float dx = wx[i] - cloud.x[q], dy = wy[i] - cloud.y[q], dz = wz[i] - cloud.z[q];
    const Surface& surface = target->surfaces.at(indices[i]);
    if (surface.weight <= 0 || dx * dx + dy * dy + dz * dz > squared_gate) continue;
    const Eigen::Vector3f place(wx[i], wy[i], wz[i]);
    if (sided && is_behind(surface, eye - place)) continue;
    const Eigen::Vector3f off = place - surface.centre;
    const float along = surface.normal.dot(off);
    const float r = surface.scale * (surface.line ? (off - along * surface.normal).norm() : along);
    residuals[i] = r;
    distances[i] = surface.line ? r : along;
    weights[i] = surface.weight;
    kernel[i] = welsch_weight(static_cast<double>(r) * r, nu);
    explained += surface.weight * kernel[i];
    ++matched;
  }
  const Vector18 e = prior_error();
  return static_cast<double>(source->size()) - explained + prior_share() * prior_cost(e.dot(held * e));
}

Vector18 ScanProblem::prior_error() const {
  Vector18 e;
  e << x, twist - prior->mean.twist, acceleration;
  return e;
}

Eigen::Matrix<double, 6, 18> ScanProblem::basis_of(int knot) const {
  Eigen::Matrix<double, 6, 18> basis;
  const double time = motion.still() ? 0.0 : motion.knot_time(knot);
  const double bend = bend_at(time, motion.middle());
  const Matrix6 turned = adjoint(se3_exp(x)) * se3_left_jacobian(time * twist + bend * acceleration);
  basis << Matrix6::Identity(), time * turned, bend * turned;
  return basis;
}

void ScanProblem::linearise(Matrix18* hessian, Vector18* gradient) const {
  std::array<KnotSums, ScanMotion::kKnots + 1> sums{};
  visit_rows([&](const Row& row) {
    const double weight = row.weight * kernel[row.point];
    KnotSums& sum = sums[static_cast<std::size_t>(row.knot)];
    sum.jj.selfadjointView<Eigen::Lower>().rankUpdate(row.j, weight);
    sum.jr += weight * row.residual * row.j;
  });
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

StateVector ScanProblem::image() {
  Matrix18 hessian;
  Vector18 gradient;
  linearise(&hessian, &gradient);
  const Vector18 e = prior_error();
  const double scale = prior_share() * nu * nu * prior_weight(e.dot(held * e));
  // A step d changes x by J_l(x)^-1 d to first order.
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

double ScanProblem::distance(const StateVector& a, const StateVector& b) const {
  const StateVector d = b - a;
  const double pose = d.head<3>().norm() + arm * d.segment<3>(3).norm();
  const double velocity = d.segment<3>(6).norm() + arm * d.segment<3>(9).norm();
  if (motion.still()) return pose;
  return pose + 0.5 * velocity + d.segment<3>(12).norm() + arm * d.segment<3>(15).norm();
}

double ScanProblem::median_absolute_residual() const {
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

}  // namespace scanlock
