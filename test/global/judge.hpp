// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>

#include "geometry/match.hpp"

namespace scanlock {

/// The largest number of matches that one rotation about z and one translation bring within epsilon, by
/// another algorithm than the solver's; only for small sets (some tens of matches within some tens of
/// epsilons). At a fixed angle each match requires t to lie in a ball about q - R p, so the consensus is the
/// largest number of balls with a common point. The lowest point of an intersection is the lowest point of
/// one ball or of the circle of two, or a corner of three: all of these are tried. Over an interval of angles
/// the number is bounded by balls whose radii are enlarged by the path of R p; intervals are halved until
/// bound and count are equal.
int judged_consensus(const Matches& matches, double epsilon);

/// The consensus of a pose, directly by equation 3, with a relative tolerance of 1e-9.
int counted_consensus(const Matches& matches, double epsilon, const Eigen::Isometry3d& target_from_source);

}  // namespace scanlock
