// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/hypothesis.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr double kMostResidual = 0.18;       // voxels
constexpr double kPriceOfContradiction = 4;  // overlap per contradiction
constexpr double kRivalOverlap = 0.75;       // of the overlap of the best pose
constexpr double kRefuted = 0.06;            // contradiction
// See log_odds().
constexpr double kOddsOfNothing = -7.6, kOddsOfOverlap = 13.6, kOddsOfLead = 27.5,
                 kOddsOfContradiction = 77.1, kLeastRival = 0.2, kMostTold = 0.2;

}  // namespace

bool confirmed(const CloudFit& fit, double voxel) {
  return fit.overlap >= kSomeOverlap && fit.contradiction <= kImpossible &&
         fit.residual <= kMostResidual * voxel;
}

double score(const CloudFit& fit) {
  return fit.overlap - kPriceOfContradiction * fit.contradiction;
}

double log_odds(const CloudFit& fit, const std::vector<CloudFit>& others) {
  double runner_up = kLeastRival;
  for (const CloudFit& other : others) runner_up = std::max(runner_up, score(other));
  const double odds = kOddsOfNothing + kOddsOfOverlap * fit.overlap + kOddsOfLead * (score(fit) - runner_up) -
                      kOddsOfContradiction * std::sqrt(std::min(fit.contradiction, kMostTold));
  return odds * std::min(1.0, static_cast<double>(fit.steep) / kFewSteep);
}

bool clearly_worse(const CloudFit& other, const CloudFit& best) {
  return other.overlap < kRivalOverlap * best.overlap || other.contradiction > kRefuted;
}

double separation(const Pose& a, const Pose& b, const Eigen::Vector3d& centre, double epsilon) {
  const double distance = (a * centre - b * centre).norm();
  const double angle = so3_log(a.linear().transpose() * b.linear()).norm();
  return std::max(distance / (kRunnerUpEpsilons * epsilon), angle / kRivalAngle);
}

Pose levelled(const Pose& pose, const Eigen::Vector3d& up, const Eigen::Vector3d& centre) {
  Pose result = pose;
  result.linear() = least_rotation(pose.linear().col(2), up) * pose.linear();
  result.translation() = pose * centre - result.linear() * centre;
  return result;
}

Pose level_fit(const PairSums& sums) {
  const Eigen::Vector3d p = sums.p / sums.weight, q = sums.q / sums.weight;
  const Eigen::Matrix3d moment = sums.qp / sums.weight - q * p.transpose();
  const double yaw = atan2(moment(1, 0) - moment(0, 1), moment(0, 0) + moment(1, 1));
  Pose pose = Pose::Identity();
  pose.linear() = so3_exp(Eigen::Vector3d(0, 0, yaw));
  pose.translation() = q - pose.linear() * p;
  return pose;
}

}  // namespace scanlock
