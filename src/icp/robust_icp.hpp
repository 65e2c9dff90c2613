// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "icp/anderson.hpp"

namespace scanlock {

/// An energy that majorisation-minimisation (algorithm 1) or Gauss-Newton (algorithm 2) decreases by a
/// fixed-point iteration x <- G(x). Scans (ScanProblem) and clouds (CloudProblem) are such problems.
class DescentProblem {
 public:
  virtual ~DescentProblem() = default;
  /// correspondence(x), equation 3, then the energy E_nu there: equation 13, 20, or 1, 19 without nu.
  virtual double evaluate(const StateVector& x) = 0;
  /// G(x) at the x evaluated last: alignment() by equation 17 (algorithm 1), G_ppl by equations 25 and 26
  /// (algorithm 2).
  virtual StateVector image() = 0;
  /// Length of the step between two states, in the unit of `DescentOptions::tolerance`.
  virtual double distance(const StateVector& a, const StateVector& b) const = 0;
};

struct DescentOptions {
  int anderson_window = 5;                  ///< m
  int max_iterations = 100;                 ///< I_nu
  int max_line_search_steps = 4;            ///< l_max; 0: none (algorithm 1)
  int patience = 1;                         ///< steps in a row without a lower energy that end it
  double tolerance = 1e-5;                  ///< epsilon_nu: stop when |G(x) - x| is below
  std::function<void(double)> step_length;  ///< told |G(x) - x| at each iterate, if set
};

struct DescentResult {
  StateVector x;
  double energy = 0;
  int iterations = 0;   ///< steps taken
  int evaluations = 0;  ///< energies computed, each a sweep over the source
  int rejected = 0;     ///< accelerated steps that did not descend
  bool converged = false;
};

/// The inner loop of algorithms 1 and 2, at one nu: Anderson acceleration; an accelerated step that does not
/// descend is replaced by the plain one, and one by Gauss-Newton that overshoots is shortened by a line
/// search. Points that change their correspondences can raise the energy on the way to a lower one, so that,
/// as in the print, the iteration may go on from a step that does not descend; it ends when `patience` of
/// them in a row have found no lower energy. What is returned is the state of the least energy, and the
/// problem is left there. With a problem of squares this is section 4.2, Fast ICP.
DescentResult descend(DescentProblem& problem, const StateVector& start, const DescentOptions& options);

/// What one nu of the graduation starts from, and how far it is driven.
struct NuLevel {
  StateVector start;
  DescentOptions descent;
};

/// Makes the problem that of `nu`, from the state `x` where the nu before it ended. The motion stays; the
/// state may be another if the problem changes its coordinates. `last`: nu == nu_min.
using BeginNu = std::function<NuLevel(const StateVector& x, double nu, bool last)>;

/// Algorithms 1 and 2, whichever the problem is of: minimises at nu_max, halves nu, and so on down to nu_min
/// (nu_max >= nu_min). State, energy and `converged` are those at nu_min, the counts those of all nu.
DescentResult robust_icp(DescentProblem& problem, const StateVector& start, double nu_max, double nu_min,
                         const BeginNu& begin);

}  // namespace scanlock
