// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/relocation.hpp"

#include <doctest/doctest.h>

#include "prepared_hall.hpp"

using namespace scanlock;

TEST_CASE("a place is not believed before its twin, which the map at hand does not show") {
  TrackerConfig config;
  config.max_keyframes = 4;
  PreparedHall hall(config);
  const PointCloud map = hall_map();
  const Pose twin(Eigen::Translation3d(40, 0, 0)), lost(Eigen::Translation3d(20, 60, 0));
  KeyframeArchive archive(10000000);
  std::vector<ArchivedKeyframe> places;
  for (float x : {-1.0f, -0.5f, 0.0f, 0.5f}) {
    PointCloud seen = map;
    for (float& px : seen.x) px -= x;
    const Pose from(Eigen::Translation3d(x, 0, 0));
    for (const Pose& at : {Pose::Identity(), twin}) places.push_back(archived(at * from, seen));
  }
  archive.restore(places);

  const PreparedScan first = hall.scan(0);
  Odometer odometer(config);
  odometer.start(0, first, {});
  odometer.reload(archive.keyframes(), {Eigen::Vector3d::Zero()}, first.voxel);
  odometer.set_pose(lost);
  Relocation relocation(config);
  relocation.distrust(0, 0, first, odometer, 1);
  relocation.begin(odometer, std::nullopt, archive);

  Attempt attempt;
  auto outcome = Relocation::Outcome::kLost;
  bool proposed = false;
  for (unsigned i = 1; i < 40 && outcome == Relocation::Outcome::kLost; ++i) {
    outcome = relocation.follow(100000 * i, 0.1, hall.scan(i), odometer, &attempt);
    const auto request = relocation.take_request(100000 * i, archive, std::nullopt);
    if (!request || proposed) continue;
    proposed = true;
    RecoveryAnswer answer;
    answer.serial = request->serial;
    answer.utime = request->utime;
    answer.verdict = PlaceVerdict::kFound;
    answer.evidence = PlaceEvidence::kClear;
    answer.certified = true;
    answer.map_from_predicted = lost.inverse();
    answer.rivals = {twin * lost.inverse()};
    relocation.give(answer, archive, first.voxel, odometer);
  }
  CHECK(proposed);
  CHECK(outcome == Relocation::Outcome::kLost);
  CHECK(relocation.state() == TrackingState::kAmbiguous);
}
