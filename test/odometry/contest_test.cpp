// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/contest.hpp"

#include <doctest/doctest.h>

#include "prepared_hall.hpp"

using namespace scanlock;

namespace {

const Pose kThere(Eigen::Translation3d(40, 0, 0));

/// How the contest ends between a hall that was seen whole and a twin of it, 40 m away, of which the map
/// knows one half: the sensor, which is in one of them, sees all of either.
Contest::Outcome between_twins(bool standing) {
  const TrackerConfig config;
  PreparedHall hall(config);
  Scan map;
  map.points = hall_map();
  const PreparedScan first = hall.scan(0);
  Odometer odometer(config);
  odometer.start(0, first, {});
  odometer.reload({archived(Pose::Identity(), map.points), archived(kThere, half_of(map).points)},
                  {{20, 0, 0}}, first.voxel);
  Excursion excursion(config, 0, first, {});
  Contest contest({Pose::Identity(), kThere}, PlaceEvidence::kSome);
  if (standing) contest.note_standing(kThere, excursion);
  Contest::Outcome outcome = Contest::Outcome::kOpen;
  for (unsigned i = 1; outcome == Contest::Outcome::kOpen; ++i) {
    const PreparedScan next = hall.scan(i);
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

TEST_CASE(
    "in a map that was just loaded a place must explain a scan about as well as the scans do each other") {
  for (const bool strange : {false, true}) {
    CAPTURE(strange);
    const TrackerConfig config;
    PreparedHall hall(config);
    PointCloud map = hall_map();
    for (float& x : map.x) x += strange && x > 11.9f ? 0.2f : 0.0f;  // one wall farther off, and another one
    for (float& y : map.y) y += strange && y > 7.9f ? 0.2f : 0.0f;
    const PreparedScan first = hall.scan(0);
    Odometer odometer(config);
    odometer.reload({archived(Pose::Identity(), map)}, {Eigen::Vector3d::Zero()}, first.voxel);
    Excursion excursion(config, 0, first, {});
    Contest contest({Pose::Identity()}, PlaceEvidence::kClear);
    Contest::Outcome outcome = Contest::Outcome::kOpen;
    for (unsigned i = 1; i < 6; ++i) excursion.follow(100000 * i, 0.1, hall.scan(i));
    for (unsigned i = 6; outcome == Contest::Outcome::kOpen; ++i) {
      const PreparedScan next = hall.scan(i);
      excursion.follow(100000 * i, 0.1, next);
      outcome = contest.judge(odometer, next, excursion);
    }
    CHECK(outcome == (strange ? Contest::Outcome::kRefuted : Contest::Outcome::kWon));
  }
}
