// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "global/branch_and_bound.hpp"
#include "global/level_frame.hpp"

namespace scanlock {

/// Sets the runner-up of a result whose pose is `first`. First a pose by a short best-first search, if weak
/// ones are wanted, then a bound on all other poses. A pose of less than half the consensus does not compete,
/// so the bound need not come below that; and the effort is bounded, for the runner-up is harder to prove
/// than the answer.
void seek_runner_up(const LevelMatches& matches, const LevelPose& first,
                    const MatchRegistrationOptions& options, const LevelFrame& frame, SearchLimits limits,
                    MatchRegistration& result);

}  // namespace scanlock
