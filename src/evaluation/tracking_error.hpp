// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "evaluation/kidnaps.hpp"
#include "evaluation/metrics.hpp"

namespace scanlock {

/// Errors of the tracked poses: those in state TRACKING or DEGRADED (all poses when the states are not known)
/// that do not lie between a kidnap and the recovery from it.
struct TrackingError {
  std::size_t poses = 0;
  Pose reference_from_estimate = Pose::Identity();  ///< from these poses alone
  AbsoluteError ate_m;
  /// For kRelativeLengths, over stretches in which every pose is tracked.
  std::array<std::optional<RelativeError>, kRelativeLengths.size()> rpe;
};

/// Error from a kidnap to the recovery from it, or to the next kidnap or the end if there is no recovery.
struct AwayError {
  std::size_t poses = 0;
  std::optional<AbsoluteError> ate_m;  ///< aligned as in KidnapReport; nothing when no pose lies in that time
};

struct SplitErrors {
  std::vector<char> tracked;              ///< for each pair: whether it is tracked
  std::optional<TrackingError> tracking;  ///< nothing when there are too few poses for the alignment
  std::vector<AwayError> away;            ///< one per kidnap
};

/// `pairs` and `states` must be in the order of time; `states` is empty when not known.
SplitErrors split_errors(const PosePairs& pairs, const std::vector<StampedState>& states,
                         const KidnapReport& report, Overlay kind);

}  // namespace scanlock
