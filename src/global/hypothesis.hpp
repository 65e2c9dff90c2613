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

/// A pose that may be right, the number of matches that it holds, and the fit of the clouds there.
struct Hypothesis {
  Pose start, refined;
  int consensus = 0;
  CloudFit fit;
  std::uint32_t degenerate_axes = 0;
};

/// True if the overlap is at least kSomeOverlap, the contradiction at most kImpossible, and the residual at
/// most 0.18 voxels; `voxel`: metres.
bool confirmed(const CloudFit& fit, double voxel);
/// overlap - 4 contradiction, for comparing hypotheses of the same two clouds; larger for a better fit.
double score(const CloudFit& fit);
/// Least overlap of a runner-up.
inline constexpr double kSomeOverlap = 0.3;
/// Largest contradiction of a possible pose; right poses hardly ever have more than 0.01.
inline constexpr double kImpossible = 0.03;
/// Logarithm of the odds that the best pose of a search is right, against the case that the map does not
/// contain the place, at even prior odds (between runners-up, the scans that follow decide). `fit`: of the
/// best pose, `others`: of the other poses. A logistic model of the overlap, the square root of the
/// contradiction, and the lead in score over the best runner-up (whose score is taken as 0.2 at least).
/// Fitted to 476 searches that had found the place and 1480 in maps that do not contain it, in towns, rooms,
/// woods and car parks of two simulators: none of the 1480 had log odds above 4.2, but 90 % of the 476 did.
/// With fewer than kFewSteep points of steep surfaces, the log odds are reduced in proportion.
double log_odds(const CloudFit& fit, const std::vector<CloudFit>& others);
/// Whether a pose with the fit `other` is excluded beside one with the fit `best`, because its overlap is
/// below 0.75 of the best one or its contradiction is above 0.06.
bool clearly_worse(const CloudFit& other, const CloudFit& best);

/// The contradiction up to which a pose counts as not contradicted. Rooms of one building can share half of
/// their surfaces, but then walls of one room are in the free space of the other.
inline constexpr double kClearContradiction = 0.025;

inline constexpr double kRunnerUpEpsilons = 4,
                        kRivalAngle = 0.1;  // epsilons and radians between different hypotheses
/// The distance between two poses of the source, in units of kRunnerUpEpsilons epsilons and kRivalAngle: from
/// 1 on they are different hypotheses. `centre`, of the source, and `epsilon`: metres.
double separation(const Pose& a, const Pose& b, const Eigen::Vector3d& centre, double epsilon);

/// The pose after the smallest rotation about `centre` of the source (metres) that turns the source's z axis
/// to `up` (unit, in the target's frame).
Pose levelled(const Pose& pose, const Eigen::Vector3d& up, const Eigen::Vector3d& centre);

/// The rotation about the vertical and translation of least squares over the pairs.
Pose level_fit(const PairSums& sums);

}  // namespace scanlock
