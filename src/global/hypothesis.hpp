// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "geometry/rigid.hpp"
#include "geometry/rigid_fit.hpp"
#include "global/cloud_check.hpp"

namespace scanlock {

/// A pose that many matches agree on, and what the clouds say to it.
struct Hypothesis {
  Pose start, refined;
  int consensus = 0;
  CloudFit fit;
  std::uint32_t degenerate_axes = 0;
};

/// The surfaces overlap, lie on each other to a share of the voxel (metres), and seldom contradict.
bool confirmed(const CloudFit& fit, double voxel);
/// Which of two poses the clouds rather believe: the higher one.
double score(const CloudFit& fit);
/// Nobody who sees both fits would take the other for as good.
bool clearly_worse(const CloudFit& other, const CloudFit& best);

/// Rooms of one building can look alike to half their surfaces, but the walls of the one stand in the free
/// space of the other: contradiction of a pose that nothing speaks against.
inline constexpr double kClearContradiction = 0.025;

inline constexpr double kRivalEpsilons = 4, kRivalAngle = 0.1;  // radians; what counts as another pose
/// How far apart two poses put the source, as a share of what counts as another pose. `centre`, of the
/// source, and `epsilon`: metres.
double separation(const Pose& a, const Pose& b, const Eigen::Vector3d& centre, double epsilon);

/// The pose turned the least that makes the source's z axis `up` (unit), about `centre` of the source.
Pose levelled(const Pose& pose, const Eigen::Vector3d& up, const Eigen::Vector3d& centre);

/// Least squares over pairs, of rotations about the vertical and translations.
Pose level_fit(const PairSums& sums);

}  // namespace scanlock
