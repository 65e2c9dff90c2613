// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/rigid.hpp"
#include "geometry/rigid_fit.hpp"
#include "global/cloud_check.hpp"

namespace scanlock {

/// A pose that may be right, the matches that it holds, and the fit of the clouds there.
struct Hypothesis {
  Pose start, refined;
  int consensus = 0;
  CloudFit fit;
  std::uint32_t degenerate_axes = 0;
};

/// Whether the overlap is large enough, the residual within a share of the voxel (metres), and the
/// contradiction small enough.
bool confirmed(const CloudFit& fit, double voxel);
/// Larger for a better fit; for comparing hypotheses of the same two clouds.
double score(const CloudFit& fit);
/// The overlap from which a pose is a rival of another one.
inline constexpr double kSomeOverlap = 0.3;
/// Contradiction: right poses hardly ever have more than 0.01.
inline constexpr double kImpossible = 0.03;
/// Logarithm of the odds that the best pose of a search is right rather than that the map does not show the
/// place, at even odds before (between rivals the scans that follow decide), by its fit and those of the
/// others: a logistic model of the overlap, the square root of the contradiction, and the lead in score over
/// the best rival (one of 0.2 where there is none). Fitted to 476 searches that had found the place and 1480
/// in maps that do not show it, in towns, rooms, woods and car parks of two simulators: of the latter none
/// had more than 4.2, of the former 90 %. Fewer than kFewSteep points of steep surfaces say less, by their
/// share.
double log_odds(const CloudFit& fit, const std::vector<CloudFit>& others);
/// Whether a pose of the fit `other` is ruled out beside one of the fit `best`: by less overlap, or
/// contradicted.
bool clearly_worse(const CloudFit& other, const CloudFit& best);

/// The contradiction below which a pose counts as not contradicted. Rooms of one building can share half of
/// their surfaces, but then walls of one stand in the free space of the other.
inline constexpr double kClearContradiction = 0.025;

inline constexpr double kRivalEpsilons = 4,
                        kRivalAngle = 0.1;  // epsilons and radians: a pose farther off is another one
/// The distance of two poses of the source, in units of kRivalEpsilons epsilons and kRivalAngle: from 1 on
/// they are different hypotheses. `centre`, of the source, and `epsilon`: metres.
double separation(const Pose& a, const Pose& b, const Eigen::Vector3d& centre, double epsilon);

/// The pose turned the least that makes the source's z axis `up` (unit), about `centre` of the source.
Pose levelled(const Pose& pose, const Eigen::Vector3d& up, const Eigen::Vector3d& centre);

/// Least squares over pairs, of rotations about the vertical and translations.
Pose level_fit(const PairSums& sums);

}  // namespace scanlock
