// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/elementary.hpp"

namespace scanlock {

/// Welsch's function, equation 14: psi(x) = 1 - exp(-x^2 / (2 nu^2)), as a function of x^2.
inline double welsch(double squared_x, double nu) {
  return -expm1(-squared_x / (2.0 * nu * nu));
}

/// The weight of the quadratic surrogate, equations 16 and 17: exp(-x^2 / (2 nu^2)).
inline double welsch_weight(double squared_x, double nu) {
  return exp(-squared_x / (2.0 * nu * nu));
}

/// Beyond this many nu the weight is below 1.6e-8, which is below the float resolution of a residual.
constexpr double kWelschReach = 6.0;

}  // namespace scanlock
