// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/bounds/conflicts.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr double kProof = 1 + 1e-11;  // the rounding of a residual is in bounding_limit()

}  // namespace

/// The minimum over all poses of the weighted mean of squared residual over squared limit, for the first
/// `size` matches of the set. Sets `pose` to the minimiser, and squares_ to the squared ratios there.
double Conflicts::weighted_mean(const Weighted& set, std::size_t size, LevelPose& pose) {
  fit_weights_.resize(size);
  squares_.resize(size);
  for (std::size_t k = 0; k < size; ++k) {
    const double limit = bounding_limit(m_, set.matches[k]);
    fit_weights_[k] = set.weights[k] / (limit * limit);
  }
  pose = fit(m_, set.matches.data(), fit_weights_.data(), size);
  const auto [s, c] = sincos(pose.theta);
  double sum = 0, weight = 0;
  for (std::size_t k = 0; k < size; ++k) {
    const std::uint32_t i = set.matches[k];
    const double limit = bounding_limit(m_, i);
    const double dx = c * m_.px[i] - s * m_.py[i] + pose.x - m_.qx[i];
    const double dy = s * m_.px[i] + c * m_.py[i] + pose.y - m_.qy[i];
    const double dz = pose.z - m_.dz[i];
    squares_[k] = (dx * dx + dy * dy + dz * dz) / (limit * limit);
    sum += set.weights[k] * squares_[k];
    weight += set.weights[k];
  }
  return sum / weight;
}

Conflicts::Verdict Conflicts::weigh(Weighted& set, int iterations, Incumbent& best) {
  const std::size_t n = set.matches.size();
  LevelPose pose;
  for (int k = 0; k < iterations; ++k) {
    if (weighted_mean(set, n, pose) > kProof) return Verdict::kConflict;
    const bool holds_all = *std::max_element(squares_.begin(), squares_.end()) <= 1 + kRelativeTolerance;
    const auto held =
        std::count_if(squares_.begin(), squares_.end(), [](double square) { return square <= 1; });
    if (static_cast<int>(held) > best.consensus || holds_all) {
      const int count = consensus(m_, pose);
      if (count > best.consensus) best = {pose, count};
    }
    if (holds_all) return Verdict::kPose;
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += set.weights[i] *= std::sqrt(squares_[i]);
    if (!(sum > 0)) return Verdict::kUndecided;
    for (double& w : set.weights) w /= sum;
  }
  touch(set, pose);
  const int count = consensus(m_, pose);
  if (count > best.consensus) best = {pose, count};
  return Verdict::kUndecided;
}

/// Moves a pose to where the matches with large weights are exactly at their thresholds (Gauss-Newton): if a
/// set has a single common pose, this finds it, while the reweighting approaches it only slowly.
void Conflicts::touch(const Weighted& set, LevelPose& pose) const {
  constexpr int kIterations = 8;
  const double heavy = 0.01 * *std::max_element(set.weights.begin(), set.weights.end());
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
    const auto [s, c] = sincos(pose.theta);
    for (std::size_t k = 0; k < set.matches.size(); ++k) {
      if (set.weights[k] < heavy) continue;
      const std::uint32_t i = set.matches[k];
      const double rx = c * m_.px[i] - s * m_.py[i], ry = s * m_.px[i] + c * m_.py[i];
      const Eigen::Vector3d d(rx + pose.x - m_.qx[i], ry + pose.y - m_.qy[i], pose.z - m_.dz[i]);
      const double length = d.norm();
      if (!(length > 0)) continue;
      const Eigen::Vector4d row(d.x() / length, d.y() / length, d.z() / length,
                                (d.y() * rx - d.x() * ry) / length);
      normal += row * row.transpose();
      gradient += row * (length - m_.threshold[i]);
    }
    normal.diagonal() *= 1 + 1e-12;
    normal.diagonal().array() += 1e-14 * normal.trace() + std::numeric_limits<double>::min();
    const Eigen::Vector4d step = normal.ldlt().solve(gradient);
    if (!step.allFinite()) return;
    pose.x -= step[0];
    pose.y -= step[1];
    pose.z -= step[2];
    pose.theta -= step[3];
  }
}

/// Moves the matches of a small conflict to the front: the fewest of the largest weights that prove it, up to
/// kMost. Returns their number; 0 if these prove no conflict.
std::size_t Conflicts::small_conflict(Weighted& set) {
  constexpr std::size_t kMost = 8;
  const std::size_t n = set.matches.size();
  for (std::size_t size = 1; size <= std::min(n, kMost); ++size) {
    const auto heaviest =
        std::max_element(set.weights.begin() + static_cast<std::ptrdiff_t>(size - 1), set.weights.end());
    const auto k = static_cast<std::size_t>(heaviest - set.weights.begin());
    std::swap(set.weights[size - 1], set.weights[k]);
    std::swap(set.matches[size - 1], set.matches[k]);
    LevelPose pose;
    if (size > 1 && weighted_mean(set, size, pose) > kProof) return size;
  }
  return 0;
}

bool Conflicts::infeasible(Weighted set, int drops, int iterations, Incumbent& best) {
  if (weigh(set, iterations, best) != Verdict::kConflict) return false;
  if (drops == 0) return true;
  const std::size_t size = small_conflict(set);
  if (size == 0) return false;
  for (std::size_t k = 0; k < size; ++k) {
    Weighted rest = set;
    rest.matches.erase(rest.matches.begin() + static_cast<std::ptrdiff_t>(k));
    rest.weights.erase(rest.weights.begin() + static_cast<std::ptrdiff_t>(k));
    const double floor =
        0.2 / static_cast<double>(rest.weights.size());  // matches that decide now may have weights near 0
    for (double& w : rest.weights) w = std::max(w, floor);
    if (!infeasible(std::move(rest), drops - 1, iterations, best)) return false;
  }
  return true;
}

bool Conflicts::infeasible(const std::vector<std::uint32_t>& list, int drops, int iterations,
                           Incumbent& best) {
  if (list.empty()) return false;
  return infeasible({list, std::vector<double>(list.size(), 1.0)}, drops, iterations, best);
}

}  // namespace scanlock
