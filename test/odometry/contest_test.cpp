// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/contest.hpp"

#include <doctest/doctest.h>

#include <memory>

#include "odometry/scan_preparation.hpp"
#include "room.hpp"

using namespace scanlock;

namespace {

const Pose kThere(Eigen::Translation3d(40, 0, 0));

ArchivedKeyframe keyframe(const Pose& pose, const PointCloud& points) {
  return {0, pose, 10.0f, std::make_shared<PointCloud>(points)};
}

/// How the contest ends between a hall that was seen whole and a twin of it, 40 m away, of which the map
/// knows one half: the sensor, which is in one of them, sees all of either.
Contest::Outcome between_twins(bool standing) {
  const TrackerConfig config;
  VoxelScale scale(config.map_points_per_scan, config.min_voxel_m, config.max_voxel_m);
  const auto scan = [&](unsigned i) {
    Scan seen = hall_scan(Pose::Identity(), Vector6::Zero(), 100000 * i, i);
    seen.points.time.clear();
    return thin_scan(seen.points, crop(seen.points, config.min_range_m, config.max_range_m), &scale, i == 0,
                     config.max_source_points);
  };
  Scan map = hall_scan(Pose::Identity(), Vector6::Zero(), 0, 100, 0.1, 30000);
  map.points.time.clear();
  const PointCloud half = half_of(map).points;
  const PreparedScan first = scan(0);
  Odometer odometer(config);
  odometer.start(0, first, {});
  odometer.reload({keyframe(Pose::Identity(), map.points), keyframe(kThere, half)}, {20, 0, 0}, first.voxel);
  Excursion excursion(config, 0, first, {});
  Contest contest({Pose::Identity(), kThere}, PlaceEvidence::kSome);
  if (standing) contest.note_standing(kThere, excursion);
  Contest::Outcome outcome = Contest::Outcome::kOpen;
  for (unsigned i = 1; outcome == Contest::Outcome::kOpen; ++i) {
    const PreparedScan next = scan(i);
    excursion.follow(100000 * i, 0.1, next);
    outcome = contest.judge(odometer, next, excursion);
  }
  return outcome;
}

}  // namespace

TEST_CASE("that the map knows little of a place does not speak against one that still stands") {
  CHECK(between_twins(false) == Contest::Outcome::kWon);
  CHECK(between_twins(true) == Contest::Outcome::kUndecided);
}
