// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/cloud_problem.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/elementary.hpp"
#include "geometry/linear.hpp"
#include "geometry/parallel.hpp"
#include "icp/welsch.hpp"

namespace scanlock {
namespace {

// Share of the trace added to the diagonal: no step along directions without information, and a solvable
// system for the other directions.
constexpr double kDamping = 1e-9;

template <typename Value>
double median_of(std::size_t n, std::size_t count, const Value& value) {
  std::vector<float> values;
  const std::size_t stride = std::max<std::size_t>(1, n / std::max<std::size_t>(1, count));
  for (std::size_t i = 0; i < n; i += stride) {
    const float v = value(i);
    if (!std::isnan(v)) values.push_back(v);
  }
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

}  // namespace

CloudProblem::CloudProblem(const PointCloud& source, const CloudTarget& target, const Setup& setup)
    : source_(source), target_(target), setup_(setup) {
  const std::size_t n = source.size();
  correspondences_.reset(target.points(), target.tree(), n, setup.candidates);
  used_ = n;
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += static_cast<double>(source.point(i).squaredNorm());
  arm_ = n > 0 ? std::sqrt(sum / static_cast<double>(n)) : 0.0;
}

void CloudProblem::use_first(std::size_t n) {
  used_ = std::min(n, source_.size());
}

StateVector CloudProblem::begin(const Pose& start, double nu, double gate) {
  base_ = start;
  nu_ = nu;
  gate_ = gate;
  return state_of(start);
}

Pose CloudProblem::pose_of(const StateVector& x) const {
  if (setup_.coordinates == MotionCoordinates::kLieAlgebra) return se3_exp(x.head<6>()) * base_;
  Pose pose = Pose::Identity();
  pose.linear() = yaw_pitch_roll(x[3], x[4], x[5]);
  pose.translation() = x.head<3>();
  return pose;
}

StateVector CloudProblem::state_of(const Pose& pose) const {
  if (setup_.coordinates == MotionCoordinates::kLieAlgebra) return se3_log(pose * base_.inverse());
  const Eigen::Matrix3d r = pose.linear();
  StateVector x(6);
  x << pose.translation(), atan2(r(1, 0), r(0, 0)), atan2(-r(2, 0), hypot(r(2, 1), r(2, 2))),
      atan2(r(2, 1), r(2, 2));
  return x;
}

double CloudProblem::distance(const StateVector& a, const StateVector& b) const {
  return (a - b).head<3>().norm() + arm_ * (a - b).tail<3>().norm();
}

Eigen::Vector3f CloudProblem::pair_normal(std::size_t i, std::size_t q,
                                          const Eigen::Matrix3f& rotation) const {
  const Eigen::Vector3f there = target_.points().normal(q);
  if (setup_.objective == IcpObjective::kPlane) return there;
  // Rusinkiewicz 2019: the sum of both normals, here halved, so that the residual is the distance to a plane
  // where the two normals agree. The signs of estimated normals are arbitrary.
  const Eigen::Vector3f here = rotation * source_.normal(i);
  return 0.5f * (here.dot(there) < 0 ? Eigen::Vector3f(there - here) : Eigen::Vector3f(there + here));
}

Eigen::Vector3f CloudProblem::moved(std::size_t i, const Motion& by) const {
  const float px = source_.x[i], py = source_.y[i], pz = source_.z[i];
  const Eigen::Matrix3f& r = by.rotation;
  return {r(0, 0) * px + r(0, 1) * py + r(0, 2) * pz + by.translation.x(),
          r(1, 0) * px + r(1, 1) * py + r(1, 2) * pz + by.translation.y(),
          r(2, 0) * px + r(2, 1) * py + r(2, 2) * pz + by.translation.z()};
}

CloudProblem::Pair CloudProblem::measure(std::size_t i, std::int32_t target, const Eigen::Vector3f& moved,
                                         const Motion& by) const {
  Pair pair;
  pair.moved = moved;
  if (target < 0) return pair;
  const std::size_t q = static_cast<std::size_t>(target);
  const Eigen::Vector3f d = moved - target_.points().point(q);
  const float squared = d.squaredNorm();
  if (squared > static_cast<float>(gate_ * gate_)) return pair;
  pair.target = target;
  pair.squared_distance = squared;
  if (setup_.objective == IcpObjective::kPoint) {
    pair.residual = std::sqrt(squared);
  } else {
    pair.normal = pair_normal(i, q, by.rotation);
    if (pair.normal.isZero(0)) return pair;
    pair.residual = pair.normal.dot(d);
  }
  const double r = pair.residual;
  const double reach = kWelschReach * nu_;
  pair.weight = !setup_.robust ? 1.0 : r * r > reach * reach ? 0.0 : welsch_weight(r * r, nu_);
  return pair;
}

CloudProblem::Pair CloudProblem::pair(std::size_t i) const {
  return measure(i, correspondences_.found(i), moved(i, motion_), motion_);
}

float CloudProblem::squared_distance(std::size_t i) const {
  const std::int32_t target = correspondences_.found(i);
  if (target < 0) return std::numeric_limits<float>::quiet_NaN();
  const float squared =
      (moved(i, motion_) - target_.points().point(static_cast<std::size_t>(target))).squaredNorm();
  return squared > static_cast<float>(gate_ * gate_) ? std::numeric_limits<float>::quiet_NaN() : squared;
}

double CloudProblem::median_distance(std::size_t count) const {
  return std::sqrt(median_of(used_, count, [&](std::size_t i) { return squared_distance(i); }));
}

double CloudProblem::median_residual(std::size_t count) const {
  return median_of(used_, count, [&](std::size_t i) { return std::abs(pair(i).residual); });
}

void CloudProblem::add_plane(const Pair& pair, Sums* sums) const {
  const Eigen::Vector3f& n = pair.normal;
  // Source and target are each rotated by half: the lever arm is that of the midpoint between the two points.
  const Eigen::Vector3f lever =
      setup_.objective == IcpObjective::kSymmetric
          ? Eigen::Vector3f(0.5f *
                            (pair.moved + target_.points().point(static_cast<std::size_t>(pair.target))))
          : pair.moved;
  const Eigen::Vector3f arm = lever.cross(n);
  const double j[6] = {n.x(), n.y(), n.z(), arm.x(), arm.y(), arm.z()};
  for (int column = 0; column < 6; ++column) {
    const double weighted = pair.weight * j[column];
    sums->gradient[column] += weighted * static_cast<double>(pair.residual);
    for (int row = column; row < 6; ++row) sums->hessian(row, column) += weighted * j[row];
  }
}

void CloudProblem::gather(std::size_t begin, std::size_t end, const Motion& by, Sums* sums) {
  const bool point = setup_.objective == IcpObjective::kPoint;
  const float gate = static_cast<float>(gate_);
  for (std::size_t i = begin; i < end; ++i) {
    const Eigen::Vector3f at = moved(i, by);
    const Pair pair = measure(i, correspondences_.find(i, at, gate, &sums->searches), at, by);
    if (setup_.robust) {
      sums->energy += 1.0 - pair.weight;
    } else if (pair.weight > 0) {
      sums->energy += static_cast<double>(pair.residual) * pair.residual;
    }
    if (!(pair.weight > 0)) continue;
    if (point) {
      sums->points.add(pair.weight, at.cast<double>(),
                       target_.points().point(static_cast<std::size_t>(pair.target)).cast<double>());
    } else {
      add_plane(pair, sums);
    }
  }
}

double CloudProblem::evaluate(const StateVector& state) {
  pose_ = pose_of(state);
  motion_ = {pose_.linear().cast<float>(), pose_.translation().cast<float>()};
  std::vector<Sums> chunks((used_ + kChunk - 1) / kChunk);
  for_each_chunk(used_, kChunk, setup_.threads, [&](std::size_t begin, std::size_t end) {
    gather(begin, end, motion_, &chunks[begin / kChunk]);
  });
  sums_ = Sums();
  for (const Sums& chunk : chunks) {
    sums_.energy += chunk.energy;
    sums_.points.add(chunk.points);
    sums_.hessian += chunk.hessian;
    sums_.gradient += chunk.gradient;
    sums_.searches += chunk.searches;
  }
  correspondences_.note(static_cast<std::int64_t>(used_), sums_.searches);
  return sums_.energy;
}

StateVector CloudProblem::image() {
  return state_of(setup_.objective == IcpObjective::kPoint ? point_step() : plane_step());
}

Pose CloudProblem::point_step() const {
  return renormalised(rigid_fit(sums_.points) * pose_);
}

Pose CloudProblem::plane_step() const {
  Matrix6 hessian = sums_.hessian.selfadjointView<Eigen::Lower>();
  const double tt = hessian.topLeftCorner<3, 3>().trace(), rr = hessian.bottomRightCorner<3, 3>().trace();
  if (!(tt > 0 && rr > 0)) return pose_;
  hessian.diagonal().head<3>().array() += kDamping * tt;
  hessian.diagonal().tail<3>().array() += kDamping * rr;
  const Vector6 step = -solve(hessian, sums_.gradient);
  return renormalised(se3_exp(step) * pose_);
}

Pose translation_by(const Eigen::Vector3d& metres) {
  Pose pose = Pose::Identity();
  pose.translation() = metres;
  return pose;
}

double open_gate(const CentredCloud& source, const CloudTarget& target, const Pose& pose) {
  return 2.0 * (pose.translation().norm() + source.diagonal + target.diagonal() + 1e-6);
}

}  // namespace scanlock
