// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "global/branch_and_bound.hpp"
#include "global/level_frame.hpp"

namespace scanlock {

/// Sets the runner-up of a result whose pose is `first`: a pose from a short best-first search, if weak
/// runner-ups are wanted, then a bound on all other poses. A pose of less than half the consensus is no
/// runner-up, so the bound need not be below that. The effort is bounded, because the bound of the runner-up
/// is harder to prove than that of the best pose.
void seek_runner_up(const LevelMatches& matches, const LevelPose& first,
                    const MatchRegistrationOptions& options, const LevelFrame& frame, SearchLimits limits,
                    MatchRegistration& result);

}  // namespace scanlock
