// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/robust_icp.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace scanlock;

namespace {

/// Rosenbrock's valley; `image` is a step against the gradient, which overshoots when `rate` is large.
struct Valley final : DescentProblem {
  double rate = 1e-3;
  StateVector x;
  std::vector<double> energies;

  static double energy(const StateVector& x) {
    return std::pow(1 - x[0], 2) + 100 * std::pow(x[1] - x[0] * x[0], 2);
  }
  double evaluate(const StateVector& at) override {
    x = at;
    energies.push_back(energy(at));
    return energies.back();
  }
  StateVector image() override {
    StateVector gradient(2);
    gradient << -2 * (1 - x[0]) - 400 * x[0] * (x[1] - x[0] * x[0]), 200 * (x[1] - x[0] * x[0]);
    return x - rate * gradient;
  }
  double distance(const StateVector& a, const StateVector& b) const override { return (a - b).norm(); }
};

DescentResult solve(Valley& valley, int window, int most = 20000, int line_search_steps = 4) {
  DescentOptions options;
  options.max_line_search_steps = line_search_steps;
  options.anderson_window = window;
  options.max_iterations = most;
  options.tolerance = 1e-7;
  StateVector start(2);
  start << -1, 1;
  return descend(valley, start, options);
}

}  // namespace

TEST_CASE("acceleration reaches the minimum in far fewer sweeps") {
  Valley plain, fast;
  const DescentResult slow = solve(plain, 0), quick = solve(fast, 5);
  CHECK(quick.converged);
  CHECK((quick.x - StateVector::Ones(2)).norm() < 1e-2);
  CHECK(4 * quick.evaluations < slow.evaluations);
}

TEST_CASE("the energy of the state that is returned never rises with more iterations") {
  for (const double rate : {1e-3, 3e-3, 1e-2}) {  // the last two overshoot
    double last = INFINITY;
    for (int most = 0; most < 40; ++most) {
      Valley valley;
      valley.rate = rate;
      const DescentResult result = solve(valley, 5, most);
      CHECK(result.energy <= last);
      CHECK(result.energy == Valley::energy(result.x));
      CHECK(valley.x == result.x);  // the problem is left at the state that is returned
      CHECK(result.evaluations == static_cast<int>(valley.energies.size()));
      last = result.energy;
    }
  }
}

TEST_CASE("the descent continues after a step that raises the energy, as far as the patience allows") {
  // As where points change their correspondences, one state on the path to the minimum has more energy than
  // the start.
  struct Ridge final : DescentProblem {
    double x = 0;
    double evaluate(const StateVector& at) override {
      x = at[0];
      return std::abs(x) + (x == 3 ? 2 : 0);
    }
    StateVector image() override { return StateVector::Constant(1, std::max(x - 1, 0.0)); }
    double distance(const StateVector& a, const StateVector& b) const override { return (a - b).norm(); }
  };
  DescentOptions options;
  options.anderson_window = 0;
  options.max_line_search_steps = 0;
  for (const int patience : {1, 2}) {
    options.patience = patience;
    Ridge ridge;
    const DescentResult result = descend(ridge, StateVector::Constant(1, 4.0), options);
    CHECK(result.converged);
    CHECK(result.x[0] == (patience == 1 ? 4 : 0));
    CHECK(ridge.x == result.x[0]);
    CHECK(result.energy == result.x[0]);
  }
}

TEST_CASE("the line search shortens a step that overshoots") {
  Valley with, without;
  with.rate = without.rate = 1e-2;
  CHECK(solve(without, 0, 100, 0).energy == 4);  // the energy of the start
  const DescentResult found = solve(with, 0, 100);
  CHECK(found.iterations > 10);
  CHECK(found.energy < 4);
}

TEST_CASE("an image that is not finite ends the descent at the last good state") {
  Valley valley;
  valley.rate = NAN;
  const DescentResult result = solve(valley, 5);
  CHECK_FALSE(result.converged);
  CHECK(result.x.allFinite());
}
