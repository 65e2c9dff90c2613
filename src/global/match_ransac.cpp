// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/match_ransac.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

/// The levelled motion of least squares for two matches; false if their lengths or heights differ too much
/// for both to be inliers.
bool pose_of_two(const Match& a, const Match& b, double epsilon, Pose& pose) {
  const Eigen::Vector3d p = b.p - a.p, q = b.q - a.q;
  const double lengths = p.head<2>().norm() - q.head<2>().norm();
  if (std::abs(lengths) > 2 * epsilon || std::abs(p.z() - q.z()) > 2 * epsilon) return false;
  const double theta = atan2(p.x() * q.y() - p.y() * q.x(), p.x() * q.x() + p.y() * q.y());
  pose.linear() = rotation_about_z(theta);
  pose.translation() = 0.5 * (a.q + b.q) - pose.linear() * (0.5 * (a.p + b.p));
  return true;
}

}  // namespace

MatchRansac ransac_matches(const Matches& matches, const MatchRansacOptions& options) {
  MatchRansac result;
  if (matches.size() < 2) return result;
  std::mt19937 random(options.seed);
  // Not a distribution of the standard library: their results differ between implementations.
  const auto draw = [&] { return static_cast<std::size_t>(random() % matches.size()); };
  double enough = static_cast<double>(options.most_samples);
  for (; static_cast<double>(result.samples) < enough; ++result.samples) {
    Pose pose = Pose::Identity();
    const std::size_t second = draw(), first = draw();  // in this order with every compiler
    if (!pose_of_two(matches[first], matches[second], options.epsilon, pose)) continue;
    const auto count = std::count_if(matches.begin(), matches.end(), [&](const Match& m) {
      return (pose * m.p - m.q).squaredNorm() <= options.epsilon * options.epsilon;
    });
    if (static_cast<int>(count) <= result.consensus) continue;
    result.consensus = static_cast<int>(count);
    result.target_from_source = pose;
    const double ratio = static_cast<double>(count) / static_cast<double>(matches.size());
    const double samples = log(1 - options.confidence) / log1p(-std::min(ratio * ratio, 1 - 1e-12));
    enough = std::min(enough, samples);
  }
  return result;
}

}  // namespace scanlock
