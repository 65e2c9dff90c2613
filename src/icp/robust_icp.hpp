// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "icp/anderson.hpp"

namespace scanlock {

/// An energy that majorisation-minimisation (algorithm 1) or Gauss-Newton (algorithm 2) decreases by a
/// fixed-point iteration x <- G(x). Implemented for scans (ScanProblem) and clouds (CloudProblem).
class DescentProblem {
 public:
  virtual ~DescentProblem() = default;
  /// Finds the correspondences at x, equation 3, and returns the energy E_nu: equation 13 or 20, or 1 or 19
  /// without nu.
  virtual double evaluate(const StateVector& x) = 0;
  /// G(x) at the x evaluated last: alignment() by equation 17 (algorithm 1), G_ppl by equations 25 and 26
  /// (algorithm 2).
  virtual StateVector image() = 0;
  /// Length of the step between two states, in the unit of `DescentOptions::tolerance`.
  virtual double distance(const StateVector& a, const StateVector& b) const = 0;
};

struct DescentOptions {
  int anderson_window = 5;        ///< m
  int max_iterations = 100;       ///< I_nu
  int max_line_search_steps = 4;  ///< l_max; 0: none (algorithm 1)
  int patience = 1;               ///< stop after this many steps in a row without a new least energy
  double tolerance = 1e-5;        ///< epsilon_nu: stop when |G(x) - x| is below this
  std::function<void(double)> step_length;  ///< called with |G(x) - x| at each iterate, if set
};

struct DescentResult {
  StateVector x;
  double energy = 0;
  int iterations = 0;   ///< steps taken
  int evaluations = 0;  ///< energies computed, each in one pass over the source
  int rejected = 0;     ///< accelerated steps that did not lower the energy
  bool converged = false;
};

/// The inner loop of algorithms 1 and 2, at one nu, with Anderson acceleration. An accelerated step that does
/// not lower the energy is replaced by the plain step, and a Gauss-Newton step that overshoots is shortened
/// by a line search. Points that change their correspondences can raise the energy on the way to a lower one,
/// so that, as in the print, the iteration may continue from a step that did not lower it; it ends after
/// `patience` steps in a row without a new least energy. Returns the state of least energy, and leaves the
/// problem evaluated there. For a problem of squares this is section 4.2, Fast ICP.
DescentResult descend(DescentProblem& problem, const StateVector& start, const DescentOptions& options);

/// The start of the descent at one nu, and its options.
struct NuLevel {
  StateVector start;
  DescentOptions descent;
};

/// Sets the problem to `nu` and returns its start, from the state `x` at which the previous nu ended. The
/// start is the same motion; its state differs from x if the problem changes its coordinates. `last`: nu is
/// nu_min.
using BeginNu = std::function<NuLevel(const StateVector& x, double nu, bool last)>;

/// Algorithm 1 or 2, depending on the problem: minimises at nu_max, halves nu, and so on down to nu_min
/// (nu_max >= nu_min), metres. State, energy and `converged` are those at nu_min, the counts are sums over
/// all nu.
DescentResult robust_icp(DescentProblem& problem, const StateVector& start, double nu_max, double nu_min,
                         const BeginNu& begin);

}  // namespace scanlock
