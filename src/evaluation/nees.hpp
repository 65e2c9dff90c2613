// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "evaluation/log_states.hpp"
#include "evaluation/matching.hpp"

namespace scanlock {

/// Normalised estimation error squared, e^T C^-1 e: with right covariances C it follows chi-square of `dof`
/// degrees of freedom, so that its mean is `dof`.
struct Nees {
  double mean = 0;       ///< infinite where a covariance is not positive definite
  double beyond_99 = 0;  ///< share of the values, 0 to 1, beyond the 99 % quantile of chi-square
  std::size_t poses = 0;
  int dof = 6;  ///< 3 (x, y, yaw) where z, roll and pitch are degenerate axes of every pose taken
};
/// 99 % quantiles of chi-square with 6 and with 3 degrees of freedom.
constexpr double kBeyond99Of6 = 16.81, kBeyond99Of3 = 11.34;

/// Metres of way from one value to the next; the second where more than kLongWay metres are judged: errors of
/// neighbouring poses are nearly one, and would be counted again and again.
constexpr double kNeesSpacing = 5, kLongNeesSpacing = 50, kLongWay = 200;

/// Of the poses in `states`, whose covariances are those of right perturbations T exp(e) of the pose in the
/// map frame. The origin of that frame is the first pose, hence
/// e = log((first_reference^-1 reference)^-1 (first_estimate^-1 estimate)).
/// Values are taken from poses that are TRACKING or DEGRADED, before the first change of epoch and before
/// `before_s` (seconds, the first kidnap). Nothing where no such pose has a covariance. `states` in the order
/// of time.
std::optional<Nees> normalised_error(const PosePairs& pairs, const std::vector<StampedState>& states,
                                     double before_s);

}  // namespace scanlock
