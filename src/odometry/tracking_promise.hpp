// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "geometry/angles.hpp"
#include "geometry/rigid.hpp"

namespace scanlock {

/// Bounds on the error, relative to the map around the robot, that 99 of 100 poses with the state TRACKING
/// meet. Poses of larger expected error are DEGRADED.
inline constexpr double kTrackedMetres = 0.05, kTrackedRadians = 1.0 * kDegree;

/// The squared length that a normally distributed vector of this covariance exceeds in one case of a hundred.
double squared_bound(const Eigen::Matrix3d& covariance);

/// The axes, as bits (see Degeneracy), along which the error of a pose of this covariance exceeds these
/// bounds in more than one case of a hundred. Only axes in `seen` are tested.
std::uint32_t unknown_axes(const Matrix6& covariance, std::uint32_t seen, double metres = kTrackedMetres,
                           double radians = kTrackedRadians);

}  // namespace scanlock
