// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/sighting.hpp"

#include <algorithm>

#include "icp/scan_alignment.hpp"

namespace scanlock {
namespace {

constexpr double kMost = 0.1, kTimesUsual = 2.0;
constexpr double kForgets = 0.1;              // of what was usual, at each scan
constexpr std::int64_t kComparable = 500000;  // microseconds

}  // namespace

Sighting sighting(std::int64_t utime, const PreparedScan& scan, const MovingPose& moving,
                  const Sighting& before, double contradiction) {
  Sighting result;
  result.map_from_body = moving.pose;
  result.utime = utime;
  result.looked_around = looks_around(scan.source);
  result.usual_contradiction = std::max(contradiction, (1 - kForgets) * before.usual_contradiction);
  if (scan.planar) return result;
  result.twist = moving.twist;
  result.source = scan.source;
  result.view = ScanView(scan.rays);
  return result;
}

/// Motion bends both scans, and the same motion both alike: only its change is taken out.
double contradiction(const Sighting& before, std::int64_t utime, const PreparedScan& scan,
                     const MovingPose& now) {
  if (scan.planar || before.source.empty() || utime - before.utime > kComparable) return 0;
  const Vector6 change = now.twist - before.twist;
  const Pose before_from_now = before.map_from_body.inverse() * now.pose;
  const ScanView view(deskewed(scan.rays, change));
  return std::max(before.view.contradicted_share(deskewed(scan.source, change), before_from_now, view),
                  view.contradicted_share(before.source, before_from_now.inverse(), before.view));
}

bool is_elsewhere(const Sighting& before, double contradiction) {
  return contradiction > std::max(kMost, kTimesUsual * before.usual_contradiction);
}

}  // namespace scanlock
