// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/hypothesis.hpp"

#include <doctest/doctest.h>

#include <vector>

namespace scanlock {
namespace {

CloudFit fit_of(double overlap, double contradiction, std::size_t steep = 1000) {
  CloudFit fit;
  fit.overlap = overlap;
  fit.contradiction = contradiction;
  fit.steep = steep;
  return fit;
}

TEST_CASE("the odds of a pose grow with its overlap and lead, and fall with its contradiction") {
  const std::vector<CloudFit> runner_up = {fit_of(0.5, 0)};
  double last = -1e9;
  for (double overlap = 0.3; overlap < 1; overlap += 0.05) {
    const double odds = log_odds(fit_of(overlap, 0.01), runner_up);
    CHECK(odds > last);
    last = odds;
  }
  for (double contradiction = 0; contradiction < 0.2; contradiction += 0.01) {
    const double odds = log_odds(fit_of(0.8, contradiction), runner_up);
    if (contradiction > 0) CHECK(odds < last);
    last = odds;
  }
  // Typical fits in rooms that the map does not show, and in rooms that it shows.
  CHECK(log_odds(fit_of(0.7, 0.02), {fit_of(0.65, 0.02)}) < 0);
  CHECK(log_odds(fit_of(0.85, 0.004), {fit_of(0.6, 0.02)}) > 5.3);
}

TEST_CASE("a pose with hardly any overlap is no runner-up") {
  const CloudFit right = fit_of(0.6, 0.01);
  CHECK(log_odds(right, {fit_of(0.19, 0)}) == log_odds(right, {}));
  CHECK(log_odds(right, {fit_of(0.31, 0)}) < log_odds(right, {}));
  CHECK(log_odds(fit_of(0.05, 0), {}) < -5);
}

TEST_CASE("few points on steep surfaces give small log odds") {
  CHECK(log_odds(fit_of(1, 0, 10), {}) == doctest::Approx(0.1 * log_odds(fit_of(1, 0), {})));
  CHECK(log_odds(fit_of(1, 0, 0), {}) == 0);
  CHECK(log_odds(fit_of(0.3, 0.3), {fit_of(0.3, 0.3)}) < -20);
}

}  // namespace
}  // namespace scanlock
