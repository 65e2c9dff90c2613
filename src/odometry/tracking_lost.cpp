// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tracker::State of a lost robot.
#include <utility>

#include "odometry/join.hpp"
#include "odometry/tracker_state.hpp"

namespace scanlock {

void Tracker::State::track_lost(const PreparedScan& scan, const ScanPrior& auxiliary, TrackedScan* tracked) {
  if (!relocalisation.has_lost_odometry()) distrust(predict());
  Attempt attempt;
  const Relocalisation::Outcome outcome =
      relocalisation.follow(time.now(), time.elapsed_s(), scan, *odometer, &attempt);
  if (auxiliary.level_from_body) relocalisation.note_up(up_in_body(auxiliary));
  finished(Stage::kAlign);
  if (outcome == Relocalisation::Outcome::kLost) {
    if (relocalisation.gives_up() || open)
      begin_submap(scan, tracked);
    else
      describe(attempt, PoseMethod::kPredicted, tracked);
    return;
  }
  const bool found = outcome == Relocalisation::Outcome::kFound;
  if (found) begin_epoch();
  const Pose predicted = relocalisation.lost_odometry().state().pose;
  join(relocalisation.lost_odometry(), renormalised(attempt.alignment.moving.pose * predicted.inverse()),
       scan.median_range, &archive);
  if (relocalisation.is_elsewhere()) reload(attempt.alignment.moving.pose.translation());
  jumped = true;
  given_ground.forget();
  trust(scan, attempt);
  jump(predicted, odometer->state().pose);
  describe(attempt, found ? PoseMethod::kGlobal : PoseMethod::kIcp, tracked);
}

void Tracker::State::begin_submap(const PreparedScan& scan, TrackedScan* tracked) {
  LostModeOdometry& lost_odometry = relocalisation.lost_odometry();
  const Matrix6 uncertain = odometer->pose_covariance() + odometer->drift();
  moved_away = archive.begin_submap(lost_odometry.seen());
  describe(lost_odometry.attempt(), PoseMethod::kIcp, tracked);
  odometer = lost_odometry.take_odometer();
  relocalisation.end();
  ++submap;
  if (open) {
    odometer->set_drift(uncertain);
    loose_since = time.now();
  } else {
    begin_epoch();
  }
  jumped = false;
  check.trust(time.now(), scan, odometer->state(), true);
  state = TrackingState::kTracking;
}

void Tracker::State::reload(const Eigen::Vector3d& centre) {
  read_map([&] {
    odometer->reload(archive.keyframes(), centre, scale.current(0), archive.fixed());
    reloaded_at = time.now();
  });
}

}  // namespace scanlock
