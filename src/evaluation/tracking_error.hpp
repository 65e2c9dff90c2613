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

/// Errors of the poses that count as tracked: they say TRACKING or DEGRADED (all do, where the states are not
/// known), and do not lie between a kidnap and the return from it.
struct TrackingError {
  std::size_t poses = 0;
  Pose reference_from_estimate = Pose::Identity();  ///< by these poses alone
  AbsoluteError ate_m;
  /// For kRelativeLengths, over stretches on which every pose counts as tracked.
  std::array<std::optional<RelativeError>, kRelativeLengths.size()> rpe;
};

/// From a kidnap to the return from it; to the next kidnap or the end, where there is none.
struct AwayError {
  std::size_t poses = 0;
  std::optional<AbsoluteError> ate_m;  ///< laid over by KidnapReport; nothing: no pose in that time
};

struct SplitErrors {
  std::vector<char> tracked;              ///< for each pair: whether it counts as tracked
  std::optional<TrackingError> tracking;  ///< nothing: too few poses for the overlay
  std::vector<AwayError> away;            ///< one for each kidnap
};

/// `pairs` and `states` in the order of time; `states` empty: not known.
SplitErrors split_errors(const PosePairs& pairs, const std::vector<StampedState>& states,
                         const KidnapReport& report, Overlay kind);

}  // namespace scanlock
