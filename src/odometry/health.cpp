// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/health.hpp"

#include <algorithm>
#include <cmath>

#include "icp/welsch.hpp"

namespace scanlock {
namespace {

/// Least standard deviation of the energy of good alignments: it differs by this much from one corner of a
/// scene to the next. A smaller spread of the history is chance.
constexpr double kLeastSpread = 0.03;

/// Standard deviation of the mean energy of n points, times sqrt(n): 0.3 sqrt(10), because single energies
/// have 0.3 and up to ten neighbours share an error. Trusted scans of recordings had 0.3 to 0.5, with long
/// tails: a chair or a door covers many of the few points of a planar scan.
constexpr double kPlanarChance = 0.95;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

double planar_chance(std::size_t points) {
  return kPlanarChance / std::sqrt(static_cast<double>(points));
}

Health HealthMonitor::assess(const std::vector<float>& residuals, const std::vector<float>& distances,
                             const std::vector<float>& weights, double scale, double chance) const {
  Health health;
  double weight_sum = 0, cost = 0;
  std::size_t matched = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (weights[i] <= 0) continue;
    const double squared = static_cast<double>(residuals[i]) * residuals[i];
    cost += weights[i] * welsch(squared, scale);
    weight_sum += weights[i];
    ++matched;
    if (is_inlier(distances[i], scale)) ++health.inliers;
  }
  if (weight_sum > 0) health.energy = cost / weight_sum;
  if (!residuals.empty())
    health.overlap = static_cast<double>(matched) / static_cast<double>(residuals.size());
  if (!residuals.empty())
    health.inlier_ratio = static_cast<double>(health.inliers) / static_cast<double>(residuals.size());
  health.short_history = count_ < kShortHistory;
  if (count_ > 0) {
    health.median_inlier_ratio =
        median({inlier_ratios_.begin(),
                inlier_ratios_.begin() + static_cast<std::ptrdiff_t>(std::min(count_, kHistory))});
    std::vector<double> recent(history_.begin(),
                               history_.begin() + static_cast<std::ptrdiff_t>(std::min(count_, kHistory)));
    health.baseline = median(recent);
    for (double& energy : recent) energy = std::abs(energy - health.baseline);
    const double spread = std::max(1.4826 * median(recent), kLeastSpread);
    health.score = (health.energy - health.baseline) / std::max(spread, chance);
  }
  return health;
}

void HealthMonitor::remember(const Health& health) {
  history_[count_ % kHistory] = health.energy;
  inlier_ratios_[count_++ % kHistory] = health.inlier_ratio;
}

}  // namespace scanlock
