// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "global/matches.hpp"

namespace scanlock {

/// Coordinate ascent over the axes of the pose: each step moves to the middle of the interval in which the
/// most matches are inliers, found exactly by stabbing (Algorithm 5; the angle by the intervals of Algorithm
/// 4). Raises the incumbent if the result has more inliers; O(n log n) for n matches near it.
void polish(const LevelMatches& matches, Incumbent& best);

}  // namespace scanlock
