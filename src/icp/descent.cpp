// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/descent.hpp"

namespace scanlock {
namespace {

constexpr double kNoiseFloor = 5.0;  // tolerances

}  // namespace

DescentResult descend(DescentProblem& problem, const StateVector& start, const DescentOptions& options) {
  DescentResult result;
  result.x = start;
  result.energy = problem.evaluate(start);
  result.evaluations = 1;
  AndersonAcceleration anderson(options.anderson_window);

  while (true) {
    const StateVector image = problem.image();
    if (!image.allFinite()) return result;
    const double step_length = problem.distance(result.x, image);
    if (options.step_length) options.step_length(step_length);
    if (step_length < options.tolerance) {
      result.converged = true;
      return result;
    }
    if (result.iterations >= options.max_iterations) return result;

    StateVector trial = anderson.next(result.x, image);
    const bool accelerated = trial != image;
    double energy = problem.evaluate(trial);
    ++result.evaluations;
    if (accelerated && !(energy < result.energy)) {
      ++result.rejected;
      anderson.reset();
      trial = image;
      energy = problem.evaluate(trial);
      ++result.evaluations;
    }
    // A step of a few tolerances that does not descend has met the noise floor: correspondences flip back and
    // forth there.
    const bool worth_searching = step_length > kNoiseFloor * options.tolerance;
    const int line_search_steps = worth_searching ? options.max_line_search_steps : 0;
    double length = 1.0;
    for (int step = 0; step < line_search_steps && !(energy < result.energy); ++step) {
      length *= 0.5;
      trial = result.x + length * (image - result.x);
      energy = problem.evaluate(trial);
      ++result.evaluations;
    }
    if (!(energy < result.energy)) {
      problem.evaluate(result.x);  // leave the problem at the state that is returned
      ++result.evaluations;
      result.converged = true;
      return result;
    }
    result.x = trial;
    result.energy = energy;
    ++result.iterations;
  }
}

}  // namespace scanlock
