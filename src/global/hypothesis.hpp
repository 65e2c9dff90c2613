// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>

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
