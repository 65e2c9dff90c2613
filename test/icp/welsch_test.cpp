// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/welsch.hpp"

#include <doctest/doctest.h>

#include <initializer_list>

using namespace scanlock;

TEST_CASE("the weight is the derivative of the function by its squared argument") {
  for (const double nu : {0.01, 0.3, 5.0}) {
    for (const double ratio : {0.0, 0.1, 1.0, 2.5}) {
      const double s = ratio * nu * nu, h = 1e-6 * nu * nu;
      const double slope = (welsch(s + h, nu) - welsch(s - h, nu)) / (2 * h);
      CHECK(2 * nu * nu * slope == doctest::Approx(welsch_weight(s, nu)).epsilon(1e-8));
    }
  }
}

TEST_CASE("the quadratic of equation 16 touches the function from above") {
  for (const double nu : {0.1, 2.0}) {
    for (double y = 0; y < 4 * nu; y += 0.1 * nu) {
      const auto surrogate = [&](double x) {
        return welsch(y * y, nu) + (x * x - y * y) / (2 * nu * nu) * welsch_weight(y * y, nu);
      };
      CHECK(surrogate(y) == doctest::Approx(welsch(y * y, nu)));
      for (double x = 0; x < 8 * nu; x += 0.05 * nu) CHECK(surrogate(x) >= welsch(x * x, nu) - 1e-15);
    }
  }
}

TEST_CASE("small residuals keep their digits") {
  CHECK(welsch(1e-20, 1.0) == doctest::Approx(5e-21));
}
