// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// Algorithms 1 (point-to-point) and 2 (point-to-plane) of Fast and Robust Iterative Closest Point, Zhang, Yao
// and Deng. A comment "1: 14, 2: 21" names the printed lines; README.md says what differs and why.
#include "icp/robust_icp.hpp"

#include <algorithm>

namespace scanlock {
namespace {

constexpr double kNoiseFloor = 5.0;  // tolerances

}  // namespace

DescentResult robust_icp(DescentProblem& problem, const StateVector& start, double nu_max, double nu_min,
                         const BeginNu& begin) {
  DescentResult result;
  result.x = start;
  double nu = nu_max;  // 1: 1, 2: 1
  while (true) {       // 1: 2, 2: 2
    const bool last = nu <= nu_min;
    const NuLevel level = begin(result.x, nu, last);
    const DescentResult found = descend(problem, level.start, level.descent);  // 1: 3-25, 2: 3-29
    result.x = found.x;
    result.energy = found.energy;
    result.converged = found.converged;
    result.iterations += found.iterations;
    result.evaluations += found.evaluations;
    result.rejected += found.rejected;
    if (last) return result;          // 1: 26, 2: 30
    nu = std::max(0.5 * nu, nu_min);  // 1: 27, 2: 31
  }
}

DescentResult descend(DescentProblem& problem, const StateVector& start, const DescentOptions& options) {
  DescentResult best;
  best.x = start;
  best.energy = problem.evaluate(start);  // 1: 1, 3, 2: 3; the print has E_prev = infinity, see README.md
  best.evaluations = 1;
  StateVector x = start;
  double energy = best.energy;
  int not_better = 0;
  AndersonAcceleration anderson(options.anderson_window);

  while (true) {
    // Alignment step and convergence. 1: 4, 14-15, 2: 3, 21-22
    const StateVector image = problem.image();
    if (!image.allFinite()) break;
    const double step_length = problem.distance(x, image);
    if (options.step_length) options.step_length(step_length);
    best.converged = step_length < options.tolerance;
    if (best.converged || best.iterations >= options.max_iterations) break;  // 1: 7, 2: 5

    // Anderson acceleration; the image itself without a history. 1: 5-6, 17-23, 2: 4, 24-27
    StateVector trial = anderson.next(x, image);
    const bool accelerated = trial != image;
    double reached = problem.evaluate(trial);  // 1: 9, 2: 7
    ++best.evaluations;

    // Ensure that the step decreases the energy. 1: 9-11, 2: 8-12 with tau = 1
    if (accelerated && !(reached < energy)) {
      ++best.rejected;
      anderson.reset();
      trial = image;
      reached = problem.evaluate(trial);
      ++best.evaluations;
    }
    // 2: 9-18. No line search for steps of at most kNoiseFloor tolerances: these are at the noise floor,
    // where correspondences flip back and forth.
    const bool worth_searching = step_length > kNoiseFloor * options.tolerance;
    const int line_search_steps = worth_searching ? options.max_line_search_steps : 0;
    double length = 1.0;
    for (int step = 0; step < line_search_steps && !(reached < energy); ++step) {
      length *= 0.5;
      trial = x + length * (image - x);
      reached = problem.evaluate(trial);
      ++best.evaluations;
    }
    x = trial;  // 1: 12, 24, 2: 19, 28
    energy = reached;
    ++best.iterations;
    if (energy < best.energy) {
      best.x = x;
      best.energy = energy;
      not_better = 0;
    } else if (++not_better == options.patience) {
      best.converged = true;
      break;
    }
  }
  if (x != best.x) {
    problem.evaluate(best.x);
    ++best.evaluations;
  }
  return best;
}

}  // namespace scanlock
