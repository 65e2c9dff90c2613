// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "evaluation/log_states.hpp"
#include "evaluation/metrics.hpp"

namespace scanlock {

/// A place where the reference jumps farther than a vehicle can move.
struct Kidnap {
  std::size_t index = 0;            ///< of the first pose after it, in the reference
  double time_s = 0;                ///< of that pose
  double jump_m = 0, jump_deg = 0;  ///< beyond the motion before
  /// Seconds from there until the estimate was again within kRecoveredMetres and kRecoveredDegrees of the
  /// reference, and stayed so for kStaysSeconds (or to the end, or the next kidnap); nothing: never.
  std::optional<double> recovery_s;
};
constexpr double kRecoveredMetres = 1.0, kRecoveredDegrees = 5.0, kStaysSeconds = 1.0;

/// A pose that differs by over 1 m or 20 degrees from where the velocity before leads, beyond what 20 m/s^2
/// and 50 rad/s^2 explain over the step. The reference is in the order of time.
std::vector<Kidnap> find_kidnaps(const Trajectory& reference);

struct KidnapReport {
  std::vector<Kidnap> kidnaps;
  /// reference_from_estimate by the poses, orientations too, before the first kidnap (all, where there is
  /// none): what comes after must not bend it.
  Pose reference_from_estimate = Pose::Identity();
  /// Times the estimate came to be over kWrongMetres off while it claimed TRACKING, by a jump of over 1 m
  /// between two claims; what it drifts while it says DEGRADED is none, nor a new epoch that begins where the
  /// last pose led. A kidnap that is noticed within kNoticedSeconds is none. Nothing where the states are not
  /// known.
  std::optional<int> wrong_jumps;
};
constexpr double kWrongMetres = 2.0, kNoticedSeconds = 0.35;

/// `states` in the order of time; empty: not known, a pose is then judged by its place alone. With kNone both
/// trajectories are in one frame. The pairs must not be empty.
KidnapReport examine_kidnaps(const Trajectory& reference, const PosePairs& pairs,
                             const std::vector<StampedState>& states, Overlay kind);

/// Seconds, a little before the first of the kidnaps; infinite where there is none.
double first_kidnap_s(const std::vector<Kidnap>& kidnaps);

/// The state at a time, or nothing within a microsecond or two. `states` in the order of time.
std::optional<TrackingState> state_at(const std::vector<StampedState>& states, double time_s);

/// Whether TRACKING or DEGRADED was said at a time; true where `states` is empty: not known.
bool claims_to_track(const std::vector<StampedState>& states, double time_s);

}  // namespace scanlock
