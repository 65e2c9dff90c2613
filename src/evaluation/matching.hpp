// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "io/trajectory.hpp"

namespace scanlock {

/// An estimated pose and the reference pose of the same time, each in the frame of its own trajectory.
struct PosePair {
  double time_s = 0;  ///< of the estimate
  double way_m = 0;   ///< metres, path length of the reference from its first pose to this one
  Pose estimate = Pose::Identity();
  Pose reference = Pose::Identity();
};
using PosePairs = std::vector<PosePair>;

/// Seconds by which the times of two paired poses may differ: 1 cm of path at walking speed; evo's default.
constexpr double kDefaultTimeTolerance = 0.01;

/// A stable sort.
void sort_by_time(Trajectory& trajectory);

/// Pairs each estimated pose with the reference pose nearest in time, if it is within `tolerance_s`. A
/// reference pose that is nearest to several estimates is paired with the nearest of them. Nothing is
/// interpolated. Both trajectories are sorted by time first; so are the pairs.
PosePairs match_by_time(Trajectory estimate, Trajectory reference,
                        double tolerance_s = kDefaultTimeTolerance);

/// Pairs the n-th poses of both trajectories, up to the end of the shorter one.
PosePairs match_by_number(const Trajectory& estimate, const Trajectory& reference);

}  // namespace scanlock
