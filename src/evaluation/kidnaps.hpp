// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "evaluation/log_states.hpp"
#include "evaluation/metrics.hpp"

namespace scanlock {

/// A time at which the reference jumps farther than a vehicle can move.
struct Kidnap {
  std::size_t index = 0;            ///< in the reference, of the first pose after the jump
  double time_s = 0;                ///< of that pose
  double jump_m = 0, jump_deg = 0;  ///< metres and degrees beyond the predicted motion
  /// Seconds from `time_s` until the estimate was again within kRecoveredMetres and kRecoveredDegrees of the
  /// reference and stayed there for kStaysSeconds (or to the end, or the next kidnap); nothing if it never
  /// was.
  std::optional<double> recovery_s;
};
constexpr double kRecoveredMetres = 1.0, kRecoveredDegrees = 5.0, kStaysSeconds = 1.0;

/// Finds poses that differ by over 1 m or 20 degrees from the pose predicted with the previous velocity,
/// beyond what 20 m/s^2 and 50 rad/s^2 explain over the step. `reference` must be in the order of time.
std::vector<Kidnap> find_kidnaps(const Trajectory& reference);

struct KidnapReport {
  std::vector<Kidnap> kidnaps;
  /// reference_from_estimate from the poses (positions and orientations) before the first kidnap, or from all
  /// poses without a kidnap; later poses are left out because a kidnap may have made them wrong.
  Pose reference_from_estimate = Pose::Identity();
  /// How often the error rose above kWrongMetres in state TRACKING, by more than 1 m since the last pose that
  /// was right. Not counted: drift in state DEGRADED, a new epoch that continues from the last pose, and
  /// errors within kNoticedSeconds after a kidnap. Nothing when the states are not known.
  std::optional<int> wrong_jumps;
};
constexpr double kWrongMetres = 2.0, kNoticedSeconds = 0.35;

/// `states` must be in the order of time; if it is empty (not known), poses are judged by their position and
/// attitude alone. With kNone both trajectories are in one frame. `pairs` must not be empty.
KidnapReport examine_kidnaps(const Trajectory& reference, const PosePairs& pairs,
                             const std::vector<StampedState>& states, Overlay kind);

/// Seconds, slightly before the first kidnap; infinite when there is none.
double first_kidnap_s(const std::vector<Kidnap>& kidnaps);

/// The state at a time; nothing when no state is within kSameTime. `states` must be in the order of time.
std::optional<TrackingState> state_at(const std::vector<StampedState>& states, double time_s);

/// Whether the state at a time is TRACKING or DEGRADED; true when `states` is empty (not known).
bool claims_to_track(const std::vector<StampedState>& states, double time_s);

}  // namespace scanlock
