// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "io/trajectory.hpp"

namespace scanlock {

/// An estimated pose and the reference pose of the same instant, each in the frame of its own trajectory.
struct PosePair {
  double time_s = 0;  ///< of the estimate
  double way_m = 0;   ///< length of the whole reference from its first pose to this one
  Pose estimate = Pose::Identity();
  Pose reference = Pose::Identity();
};
using PosePairs = std::vector<PosePair>;

/// Seconds by which two poses of one instant may differ; that is 1 cm of way at walking speed, and evo's
/// default.
constexpr double kDefaultTimeTolerance = 0.01;

/// Stable.
void sort_by_time(Trajectory& trajectory);

/// Pairs each estimated pose with the reference pose nearest in time, when that is within `tolerance_s`; a
/// reference pose that is nearest to several estimates goes to the nearest of them. Nothing is interpolated.
/// Both are brought into the order of time first; the pairs come in that order.
PosePairs match_by_time(Trajectory estimate, Trajectory reference,
                        double tolerance_s = kDefaultTimeTolerance);

/// Pairs the n-th pose with the n-th, as far as both go.
PosePairs match_by_number(const Trajectory& estimate, const Trajectory& reference);

}  // namespace scanlock
