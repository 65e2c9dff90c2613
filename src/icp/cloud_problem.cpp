// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/cloud_problem.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "icp/welsch.hpp"

namespace scanlock {
namespace {

// Directions without information take no step, and do not spoil the others.
constexpr double kDamping = 1e-9;

}  // namespace

CloudProblem::CloudProblem(const PointCloud& source, const CloudTarget& target, const Setup& setup)
    : source_(source), target_(target), setup_(setup) {
  const std::size_t n = source.size();
  correspondences_.reset(target.points(), target.tree(), n);
  for (std::vector<float>* values : {&x_, &y_, &z_, &residuals_, &squared_distances_, &weights_})
    values->resize(n);
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += static_cast<double>(source.point(i).squaredNorm());
  arm_ = n > 0 ? std::sqrt(sum / static_cast<double>(n)) : 0.0;
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
  pose.linear() =
      (Eigen::AngleAxisd(x[3], Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(x[4], Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(x[5], Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  pose.translation() = x.head<3>();
  return pose;
}

StateVector CloudProblem::state_of(const Pose& pose) const {
  if (setup_.coordinates == MotionCoordinates::kLieAlgebra) return se3_log(pose * base_.inverse());
  const Eigen::Matrix3d r = pose.linear();
  StateVector x(6);
  x << pose.translation(), std::atan2(r(1, 0), r(0, 0)), std::atan2(-r(2, 0), std::hypot(r(2, 1), r(2, 2))),
      std::atan2(r(2, 1), r(2, 2));
  return x;
}

double CloudProblem::distance(const StateVector& a, const StateVector& b) const {
  return (a - b).head<3>().norm() + arm_ * (a - b).tail<3>().norm();
}

Eigen::Vector3f CloudProblem::pair_normal(std::size_t i, std::size_t q,
                                          const Eigen::Matrix3f& rotation) const {
  const Eigen::Vector3f there = target_.points().normal(q);
  if (setup_.objective == IcpObjective::kPlane) return there;
  // Rusinkiewicz 2019: the sum of both normals. Its half is the distance to a plane where they agree; signs
  // of estimated normals mean nothing.
  const Eigen::Vector3f here = rotation * source_.normal(i);
  return 0.5f * (here.dot(there) < 0 ? Eigen::Vector3f(there - here) : Eigen::Vector3f(there + here));
}

void CloudProblem::measure_pair(std::size_t i, std::size_t q, const Eigen::Matrix3f& rotation) {
  const Eigen::Vector3f d = Eigen::Vector3f(x_[i], y_[i], z_[i]) - target_.points().point(q);
  const float squared = d.squaredNorm();
  squared_distances_[i] = squared;
  if (squared > static_cast<float>(gate_ * gate_)) return;
  if (setup_.objective == IcpObjective::kPoint) {
    residuals_[i] = std::sqrt(squared);
  } else {
    const Eigen::Vector3f normal = pair_normal(i, q, rotation);
    if (normal.isZero(0)) return;
    residuals_[i] = normal.dot(d);
  }
  const double r = residuals_[i];
  weights_[i] = setup_.robust ? static_cast<float>(welsch_weight(r * r, nu_)) : 1.0f;
}

double CloudProblem::evaluate(const StateVector& state) {
  pose_ = pose_of(state);
  const Eigen::Matrix3f rotation = pose_.linear().cast<float>();
  const Eigen::Vector3f translation = pose_.translation().cast<float>();
  const std::size_t n = source_.size();
  for (std::size_t i = 0; i < n; ++i) {
    const float px = source_.x[i], py = source_.y[i], pz = source_.z[i];
    x_[i] = rotation(0, 0) * px + rotation(0, 1) * py + rotation(0, 2) * pz + translation.x();
    y_[i] = rotation(1, 0) * px + rotation(1, 1) * py + rotation(1, 2) * pz + translation.y();
    z_[i] = rotation(2, 0) * px + rotation(2, 1) * py + rotation(2, 2) * pz + translation.z();
  }
  correspondences_.update(x_, y_, z_, static_cast<float>(gate_), setup_.threads);
  const std::vector<std::int32_t>& indices = correspondences_.indices();
  double energy = 0;
  for (std::size_t i = 0; i < n; ++i) {
    residuals_[i] = squared_distances_[i] = std::numeric_limits<float>::quiet_NaN();
    weights_[i] = 0;
    if (indices[i] >= 0) measure_pair(i, static_cast<std::size_t>(indices[i]), rotation);
    if (setup_.robust) {
      energy += 1.0 - static_cast<double>(weights_[i]);
    } else if (weights_[i] > 0) {
      energy += static_cast<double>(residuals_[i]) * residuals_[i];
    }
  }
  return energy;
}

StateVector CloudProblem::image() {
  return state_of(setup_.objective == IcpObjective::kPoint ? point_step() : plane_step());
}

Pose CloudProblem::point_step() const {
  PairSums sums;
  const PointCloud& to = target_.points();
  const std::vector<std::int32_t>& indices = correspondences_.indices();
  for (std::size_t i = 0; i < source_.size(); ++i) {
    if (weights_[i] <= 0) continue;
    sums.add(weights_[i], Eigen::Vector3f(x_[i], y_[i], z_[i]).cast<double>(),
             to.point(static_cast<std::size_t>(indices[i])).cast<double>());
  }
  return renormalised(rigid_fit(sums) * pose_);
}

Pose CloudProblem::plane_step() const {
  Matrix6 hessian = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  const Eigen::Matrix3f rotation = pose_.linear().cast<float>();
  const PointCloud& to = target_.points();
  const std::vector<std::int32_t>& indices = correspondences_.indices();
  const bool symmetric = setup_.objective == IcpObjective::kSymmetric;
  for (std::size_t i = 0; i < source_.size(); ++i) {
    if (weights_[i] <= 0) continue;
    const std::size_t q = static_cast<std::size_t>(indices[i]);
    const Eigen::Vector3f normal = pair_normal(i, q, rotation);
    const Eigen::Vector3f moved(x_[i], y_[i], z_[i]);
    // Half of the rotation each on source and target: the lever is the middle between the two.
    const Eigen::Vector3f lever = symmetric ? Eigen::Vector3f(0.5f * (moved + to.point(q))) : moved;
    Vector6 j;
    j << normal.cast<double>(), lever.cross(normal).cast<double>();
    const double w = weights_[i];
    hessian.selfadjointView<Eigen::Lower>().rankUpdate(j, w);
    gradient += w * static_cast<double>(residuals_[i]) * j;
  }
  const double tt = hessian.topLeftCorner<3, 3>().trace(), rr = hessian.bottomRightCorner<3, 3>().trace();
  if (!(tt > 0 && rr > 0)) return pose_;
  hessian = hessian.selfadjointView<Eigen::Lower>();
  hessian.diagonal().head<3>().array() += kDamping * tt;
  hessian.diagonal().tail<3>().array() += kDamping * rr;
  const Vector6 step = -hessian.ldlt().solve(gradient);
  return renormalised(se3_exp(step) * pose_);
}

}  // namespace scanlock
