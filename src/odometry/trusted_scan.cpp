// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/trusted_scan.hpp"

#include <algorithm>

#include "geometry/elementary.hpp"
#include "odometry/scan_view.hpp"

namespace scanlock {
namespace {

constexpr std::int64_t kComparable =
    4000000;  // microseconds: longer than the gap that a step of the clock may hide

constexpr double kUntold = 0.03;  // contradiction that is as frequent after a kidnap as without one

// The model of kidnap_log_odds(): four fitted factors. The two scales are values that few scans of an
// ordinary drive exceed.
constexpr double kOddsOfNothing = -7.8, kOddsOfGap = 2.5, kOddsOfContradiction = 4.1, kOddsOfOutliers = 14;
constexpr double kUsualGap = 0.1, kUsualContradiction = 0.02;
// More contradiction tells no more. The bound saves the comparison of 93 % of the scans, see
// most_kidnap_odds().
constexpr double kMostTelling = 0.5;

}  // namespace

TrustedScan trusted_scan(std::int64_t utime, const PreparedScan& scan, const MovingPose& moving) {
  TrustedScan result;
  result.map_from_body = moving.pose;
  result.utime = utime;
  result.twist = moving.twist;
  result.source = scan.source;
  result.rays = scan.rays;
  return result;
}

/// Motion distorts both scans, and the same velocity distorts both alike: only its change is compensated.
double contradiction(const TrustedScan& before, std::int64_t utime, const PreparedScan& scan,
                     const MovingPose& now) {
  if (before.rays.empty() || scan.rays.empty() || utime - before.utime > kComparable) return kUntold;
  const MovingPose change{Pose::Identity(), now.twist - before.twist};
  const Pose before_from_now = before.map_from_body.inverse() * now.pose;
  const ScanView then_view(before.rays), now_view(deskewed(scan.rays, change));
  return std::max(then_view.contradicted_share(deskewed(scan.source, change), before_from_now, now_view),
                  now_view.contradicted_share(before.source, before_from_now.inverse(), then_view));
}

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
