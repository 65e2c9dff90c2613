// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/matching.hpp"

#include <algorithm>
#include <cmath>

namespace scanlock {
namespace {

std::vector<double> way_along(const Trajectory& trajectory) {
  std::vector<double> way(trajectory.size(), 0.0);
  for (std::size_t i = 1; i < trajectory.size(); ++i)
    way[i] = way[i - 1] + (trajectory[i].pose.translation() - trajectory[i - 1].pose.translation()).norm();
  return way;
}

}  // namespace

void sort_by_time(Trajectory& trajectory) {
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.time_s < b.time_s; });
}

PosePairs match_by_time(Trajectory estimate, Trajectory reference, double tolerance_s) {
  sort_by_time(estimate);
  sort_by_time(reference);
  const std::vector<double> way = way_along(reference);
  // Times near 1.6e9 s are rounded to 0.2 us; without slack, a difference of 10 ms could exceed 10 ms.
  const double tolerance = tolerance_s + 1e-6;
  PosePairs pairs;
  std::size_t nearest = 0, last_used = reference.size();
  for (const StampedPose& stamped : estimate) {
    const auto off = [&](std::size_t k) { return std::abs(reference[k].time_s - stamped.time_s); };
    while (nearest + 1 < reference.size() && off(nearest + 1) <= off(nearest)) ++nearest;
    if (reference.empty() || off(nearest) > tolerance) continue;
    const PosePair pair{stamped.time_s, way[nearest], stamped.pose, reference[nearest].pose};
    if (nearest != last_used)
      pairs.push_back(pair);
    else if (off(nearest) < std::abs(reference[nearest].time_s - pairs.back().time_s))
      pairs.back() = pair;
    last_used = nearest;
  }
  return pairs;
}

PosePairs match_by_number(const Trajectory& estimate, const Trajectory& reference) {
  const std::vector<double> way = way_along(reference);
  PosePairs pairs(std::min(estimate.size(), reference.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i)
    pairs[i] = {estimate[i].time_s, way[i], estimate[i].pose, reference[i].pose};
  return pairs;
}

}  // namespace scanlock
