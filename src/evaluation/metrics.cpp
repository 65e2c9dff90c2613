// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/metrics.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr double kDegrees = 180.0 / 3.14159265358979323846;

Eigen::Matrix3Xd positions(const PosePairs& pairs, Pose PosePair::*which) {
  Eigen::Matrix3Xd matrix(3, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i)
    matrix.col(static_cast<Eigen::Index>(i)) = (pairs[i].*which).translation();
  return matrix;
}

/// Maximises sum r . R(yaw) e over the centred positions: A cos(yaw) + B sin(yaw) has its maximum at atan2(B,
/// A).
Pose best_yaw(const Eigen::Matrix3Xd& estimate, const Eigen::Matrix3Xd& reference) {
  const Eigen::Vector3d estimate_mean = estimate.rowwise().mean(),
                        reference_mean = reference.rowwise().mean();
  const Eigen::Matrix3Xd e = estimate.colwise() - estimate_mean, r = reference.colwise() - reference_mean;
  const double cosine = e.row(0).dot(r.row(0)) + e.row(1).dot(r.row(1));
  const double sine = e.row(0).dot(r.row(1)) - e.row(1).dot(r.row(0));
  Pose pose = Pose::Identity();
  pose.linear() = rotation_about_z(atan2(sine, cosine));
  pose.translation() = reference_mean - pose.linear() * estimate_mean;
  return pose;
}

/// Index of the first pair from `first` on that is at least `length_m` farther along the reference, or the
/// number of pairs.
std::size_t end_of_stretch(const PosePairs& pairs, std::size_t first, double length_m) {
  const double target = pairs[first].way_m + length_m;
  const auto found = std::lower_bound(pairs.begin() + static_cast<std::ptrdiff_t>(first), pairs.end(), target,
                                      [](const PosePair& pair, double way) { return pair.way_m < way; });
  return static_cast<std::size_t>(found - pairs.begin());
}

/// Adds the error of one stretch, divided by `way_m` metres, to the sums of percent and deg/m.
void add_stretch(const PosePair& from, const PosePair& to, double way_m, RelativeError& sum) {
  const Pose reference = from.reference.inverse() * to.reference;
  const Pose estimate = from.estimate.inverse() * to.estimate;
  const Pose error = reference.inverse() * estimate;
  sum.percent += error.translation().norm() / way_m * 100;
  sum.deg_per_m += so3_log(error.linear()).norm() * kDegrees / way_m;
  ++sum.stretches;
}

void add_stretches(const PosePairs& pairs, double length_m, RelativeError& sum) {
  for (std::size_t first = 0; first < pairs.size(); ++first) {
    const std::size_t last = end_of_stretch(pairs, first, length_m);
    if (last == pairs.size()) break;
    add_stretch(pairs[first], pairs[last], pairs[last].way_m - pairs[first].way_m, sum);
  }
}

std::optional<RelativeError> mean_of(RelativeError sum) {
  if (sum.stretches == 0) return std::nullopt;
  sum.percent /= static_cast<double>(sum.stretches);
  sum.deg_per_m /= static_cast<double>(sum.stretches);
  return sum;
}

}  // namespace

std::size_t poses_needed(Overlay kind) {
  return kind == Overlay::kSe3 ? 3 : kind == Overlay::kYaw ? 2 : 1;
}

Pose overlay(const PosePairs& pairs, Overlay kind) {
  if (kind == Overlay::kNone) return Pose::Identity();
  const Eigen::Matrix3Xd estimate = positions(pairs, &PosePair::estimate);
  const Eigen::Matrix3Xd reference = positions(pairs, &PosePair::reference);
  if (kind == Overlay::kYaw) return best_yaw(estimate, reference);
  return Pose(Eigen::umeyama(estimate, reference, false));
}

std::vector<double> position_errors(const PosePairs& pairs, const Pose& reference_from_estimate) {
  std::vector<double> errors;
  for (const PosePair& pair : pairs)
    errors.push_back(
        (reference_from_estimate * pair.estimate.translation() - pair.reference.translation()).norm());
  return errors;
}

AbsoluteError absolute_error(const std::vector<double>& errors) {
  std::vector<double> sorted = errors;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  const double squares = std::inner_product(sorted.begin(), sorted.end(), sorted.begin(), 0.0);
  return {std::sqrt(squares / static_cast<double>(n)), (sorted[(n - 1) / 2] + sorted[n / 2]) / 2,
          sorted.back()};
}

std::optional<RelativeError> relative_error(const std::vector<PosePairs>& runs, double length_m) {
  RelativeError sum;
  for (const PosePairs& run : runs) add_stretches(run, length_m, sum);
  return mean_of(sum);
}

std::optional<RelativeError> relative_error(const PosePairs& pairs, double length_m) {
  RelativeError sum;
  add_stretches(pairs, length_m, sum);
  return mean_of(sum);
}

std::optional<RelativeError> kitti_error(const PosePairs& pairs) {
  RelativeError sum;
  for (std::size_t first = 0; first < pairs.size(); first += 10) {
    for (double length_m = 100; length_m <= 800; length_m += 100) {
      const std::size_t last = end_of_stretch(pairs, first, length_m);
      if (last == pairs.size()) break;
      add_stretch(pairs[first], pairs[last], length_m, sum);  // the development kit divides by nominal length
    }
  }
  return mean_of(sum);
}

Evaluation evaluate(const PosePairs& pairs, std::size_t poses, Overlay kind) {
  if (pairs.empty()) throw std::runtime_error("no pose of the estimate has a match in the reference");
  const std::size_t needed = poses_needed(kind);
  if (pairs.size() < needed)
    throw std::runtime_error("only " + std::to_string(pairs.size()) +
                             " matched poses; this alignment needs " + std::to_string(needed));
  Evaluation result;
  result.poses = poses;
  result.matched = pairs.size();
  result.length_m = pairs.back().way_m - pairs.front().way_m;
  result.reference_from_estimate = overlay(pairs, kind);
  result.ate_m = absolute_error(position_errors(pairs, result.reference_from_estimate));
  for (std::size_t i = 0; i < kRelativeLengths.size(); ++i)
    result.rpe[i] = relative_error(pairs, kRelativeLengths[i]);
  result.kitti = kitti_error(pairs);
  return result;
}

}  // namespace scanlock
