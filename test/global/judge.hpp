// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>

#include "geometry/match.hpp"

namespace scanlock {

/// The largest number of matches that one rotation about z and one translation bring within epsilon: by
/// another way than the solver, for small sets only (some tens of matches within some tens of epsilons). At a
/// fixed angle a match asks of t to lie in a ball about q - R p, so the consensus is the largest number of
/// balls with a common point. The lowest point of a common part is the lowest point of one ball or of the
/// circle of two, or a corner of three: all of these are tried. Over an interval of angles, balls that are
/// wider by the way of R p bound the number; intervals are halved until bound and count meet.
int judged_consensus(const Matches& matches, double epsilon);

/// How many matches a pose holds, straight from equation 3, with a part in 1e9 of tolerance.
int counted_consensus(const Matches& matches, double epsilon, const Eigen::Isometry3d& target_from_source);

}  // namespace scanlock
