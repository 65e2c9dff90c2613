// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/trusted_scan.hpp"

#include <algorithm>

#include "odometry/scan_view.hpp"

namespace scanlock {
namespace {

constexpr std::int64_t kComparable =
    4000000;  // microseconds: longer than the gap that a step of the clock may hide

constexpr double kUntold = 0.03;  // contradiction that is as frequent after a kidnap as without one

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

}  // namespace scanlock
