// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>

#include "icp/anderson.hpp"

namespace scanlock {

/// An energy that majorisation-minimisation (or Gauss-Newton) decreases by a fixed-point iteration.
class DescentProblem {
 public:
  virtual ~DescentProblem() = default;
  /// Makes x current (moves the source, updates its correspondences) and returns the energy at x.
  virtual double evaluate(const StateVector& x) = 0;
  /// G(x) at the current x: where the surrogate that was built there has its minimum.
  virtual StateVector image() = 0;
  /// Length of the step between two states, in the unit of `DescentOptions::tolerance`.
  virtual double distance(const StateVector& a, const StateVector& b) const = 0;
};

struct DescentOptions {
  int anderson_window = 5;
  int max_iterations = 100;
  int max_line_search_steps = 4;            ///< 0 where the image is known to descend (closed-form alignment)
  double tolerance = 1e-5;                  ///< stop when |G(x) - x| is below
  std::function<void(double)> step_length;  ///< told |G(x) - x| at each iterate, if set
};

struct DescentResult {
  StateVector x;
  double energy = 0;
  int iterations = 0;   ///< accepted steps
  int evaluations = 0;  ///< energies computed, each a sweep over the source
  int rejected = 0;     ///< accelerated steps that did not descend
  bool converged = false;
};

/// The inner loop of algorithms 1 and 2 for one nu: Anderson acceleration, each step checked to descend. An
/// accelerated step that does not is replaced by the plain one; where even that one does not (Gauss-Newton
/// overshoots), a line search shortens it; when no length descends, x is a minimum to within rounding and the
/// loop ends. Against the print: algorithm 2 keeps the best trial of a failed line search even when it is
/// higher than E_prev, which loses monotony; here the energy never rises.
DescentResult descend(DescentProblem& problem, const StateVector& start, const DescentOptions& options);

}  // namespace scanlock
