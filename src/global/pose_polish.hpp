// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "global/matches.hpp"

namespace scanlock {

/// Climbs along one axis of the pose after the other: each time to the middle of the stretch that holds most
/// matches, which is found exactly by stabbing (Algorithm 5; the angle by the intervals of Algorithm 4).
/// Raises the incumbent if it can; O(n log n) in the matches near it.
void polish(const LevelMatches& matches, Incumbent& best);

}  // namespace scanlock
