// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "geometry/angles.hpp"
#include "geometry/rigid.hpp"

namespace scanlock {

/// What TRACKING promises: of a hundred such poses 99 are as near as this to the truth, against the map
/// around the robot. All others are DEGRADED.
inline constexpr double kTrackedMetres = 0.05, kTrackedRadians = 1.0 * kDegree;

/// The length, squared, that a normal vector of this covariance exceeds in one case of a hundred.
double squared_bound(const Eigen::Matrix3d& covariance);

/// The axes, as bits (see Degeneracy), along which a pose of this covariance is not known so well: of a
/// hundred 99 are as near as this to the truth. Of those in `seen` alone.
std::uint32_t unknown_axes(const Matrix6& covariance, std::uint32_t seen, double metres = kTrackedMetres,
                           double radians = kTrackedRadians);

}  // namespace scanlock
