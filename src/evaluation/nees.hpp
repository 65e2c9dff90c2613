// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "evaluation/log_states.hpp"
#include "evaluation/matching.hpp"

namespace scanlock {

/// Normalised estimation error squared (NEES), e^T C^-1 e. If the covariances C are right, it has a
/// chi-square distribution with `dof` degrees of freedom, so that its mean is `dof`.
struct Nees {
  double mean = 0;       ///< infinite when a covariance is not positive definite
  double beyond_99 = 0;  ///< fraction of the values, 0 to 1, above the 99 % quantile of chi-square
  std::size_t poses = 0;
  int dof = 6;  ///< 3 (x, y, yaw) when z, roll and pitch are degenerate axes of every pose used
};
/// 99 % quantiles of chi-square with 6 and with 3 degrees of freedom.
constexpr double kBeyond99Of6 = 16.81, kBeyond99Of3 = 11.34;

/// Metres of path between two values; the second spacing when the path is longer than kLongWay metres. Errors
/// of neighbouring poses are almost equal, and a smaller spacing would count them repeatedly.
constexpr double kNeesSpacing = 5, kLongNeesSpacing = 50, kLongWay = 200;

/// Of the poses in `states`, whose covariances are those of right perturbations T exp(e) of the pose in the
/// map frame. The origin of that frame is the first pose, hence
/// e = log((first_reference^-1 reference)^-1 (first_estimate^-1 estimate)).
/// Uses poses in state TRACKING or DEGRADED before the first change of epoch and before `before_s` (seconds,
/// the first kidnap). Nothing when none of these poses has a covariance. `states` must be in the order of
/// time.
std::optional<Nees> normalised_error(const PosePairs& pairs, const std::vector<StampedState>& states,
                                     double before_s);

}  // namespace scanlock
