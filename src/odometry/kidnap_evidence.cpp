// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/kidnap_evidence.hpp"

#include <algorithm>

#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

// The model of kidnap_log_odds(): four fitted factors. The two scales are values that few scans of an
// ordinary drive exceed.
constexpr double kOddsOfNothing = -7.8, kOddsOfGap = 2.5, kOddsOfContradiction = 4.1, kOddsOfOutliers = 14;
constexpr double kUsualGap = 0.1, kUsualContradiction = 0.02;
// More contradiction tells no more. The bound saved the comparison of 90 % of the scans of the fit, see
// most_kidnap_odds().
constexpr double kMostTelling = 0.5;

}  // namespace

double most_kidnap_odds(KidnapEvidence evidence) {
  evidence.contradiction = kMostTelling;
  return kidnap_log_odds(evidence);
}

double kidnap_log_odds(const KidnapEvidence& evidence) {
  const double contradiction = std::min(evidence.contradiction, kMostTelling);
  return kOddsOfNothing + kOddsOfGap * log1p(evidence.squared_gap / kUsualGap) +
         kOddsOfContradiction * log1p(contradiction / kUsualContradiction) +
         kOddsOfOutliers * std::max(1 - evidence.inlier_ratio, 0.0);
}

}  // namespace scanlock
