// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/anderson.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "../geometry/random_reflections.hpp"

using namespace scanlock;

namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// G(x) = A x + b with a slow contraction A.
struct LinearIteration {
  Matrix6d a;
  Eigen::Matrix<double, 6, 1> b, fixed;
  LinearIteration() {
    std::mt19937 random(5);
    const Matrix6d q = random_reflections<Matrix6d>(random);
    Eigen::Matrix<double, 6, 1> values;
    values << 0.98, 0.95, 0.9, 0.8, 0.6, 0.3;
    a = q * values.asDiagonal() * q.transpose();
    b.setLinSpaced(6, -1, 2);
    fixed = q * (1.0 - values.array()).inverse().matrix().asDiagonal() * q.transpose() * b;
  }
  StateVector operator()(const StateVector& x) const { return a * x + b; }
};

int steps_to(double tolerance, int window) {
  const LinearIteration g;
  AndersonAcceleration anderson(window);
  StateVector x = StateVector::Zero(6);
  int steps = 0;
  for (; (x - g.fixed).norm() > tolerance && steps < 5000; ++steps) x = anderson.next(x, g(x));
  return steps;
}

}  // namespace

TEST_CASE("without a window the acceleration is the plain iteration") {
  const LinearIteration g;
  AndersonAcceleration anderson(0);
  StateVector x = StateVector::Zero(6);
  for (int i = 0; i < 10; ++i) {
    const StateVector image = g(x);
    x = anderson.next(x, image);
    CHECK(x == image);
  }
}

TEST_CASE("a linear iteration of slow contraction is solved in few steps") {
  const int plain = steps_to(1e-8, 0), accelerated = steps_to(1e-8, 5);
  CHECK(plain > 500);
  CHECK(accelerated < 60);
}

TEST_CASE("the first step and the first step after a reset are plain iterations") {
  const LinearIteration g;
  AndersonAcceleration anderson;
  StateVector x = StateVector::Ones(6);
  CHECK(anderson.next(x, g(x)) == g(x));
  x = g(x);
  CHECK(anderson.next(x, g(x)) != g(x));
  anderson.reset();
  CHECK(anderson.next(x, g(x)) == g(x));
}

TEST_CASE("one earlier iterate gives the secant step of equation 7") {
  // In one dimension with m = 1 equation 7 is the secant method on F(x) = G(x) - x.
  const auto g = [](double x) { return std::cos(x); };
  AndersonAcceleration anderson(1);
  StateVector x0(1), x1(1), image(1);
  x0 << 0.5;
  image << g(0.5);
  x1 = anderson.next(x0, image);
  image << g(x1[0]);
  const StateVector x2 = anderson.next(x1, image);
  const double f0 = g(x0[0]) - x0[0], f1 = g(x1[0]) - x1[0];
  CHECK(x2[0] == doctest::Approx(x1[0] - f1 * (x1[0] - x0[0]) / (f1 - f0)).epsilon(1e-12));
}

TEST_CASE("a stalled iteration stays finite") {
  AndersonAcceleration anderson;
  const StateVector x = StateVector::Ones(6);
  for (int i = 0; i < 8; ++i) CHECK(anderson.next(x, x) == x);
}
