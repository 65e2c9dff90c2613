// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Tracker::State of a robot that is not lost.
#include <algorithm>
#include <utility>

#include "geometry/moved_cloud.hpp"
#include "odometry/tracker_state.hpp"
#include "odometry/tracking_promise.hpp"

namespace scanlock {
namespace {

constexpr std::uint32_t kHorizontal = 0b000011;  // x, y: see Degeneracy
constexpr int kAttitudes = 100;                  // over which the upward direction is averaged
constexpr double kCovered = 0.5;  // least ratio of the numbers of points of the first two scans
constexpr int kFalseStarts = 3;   // scans that do not fit the first one, which is then replaced

}  // namespace

PreparedScan Tracker::State::prepare(const Scan& scan, TrackedScan* tracked) {
  const double min_range = is_planar(scan.points) ? config.planar_min_range_m : config.min_range_m;
  const CroppedScan cropped = crop(scan.points, min_range, config.max_range_m);
  PreparedScan prepared = thin_scan(scan.points, cropped, &scale, !begun, config.max_source_points);
  tracked->points_used = static_cast<int>(prepared.source.size());
  if (prepared.source.size() < kLeastPoints) {
    tracked->verdict = ScanVerdict::kEmpty;
    tracked->why = why_too_few(scan.points, cropped, min_range, config.max_range_m);
  }
  finished(Stage::kPreprocess);
  return prepared;
}

MotionPrior Tracker::State::predict(const ScanPrior& auxiliary) const {
  const auto after = [&](double seconds) {
    return auxiliary.motion ? odometer->predict(seconds, *auxiliary.motion) : odometer->predict(seconds);
  };
  MotionPrior prior = after(time.elapsed_s());
  if (time.most_elapsed_s() > time.elapsed_s()) prior.information = after(time.most_elapsed_s()).information;
  return prior;
}

void Tracker::State::note_attitude(const ScanPrior& auxiliary) {
  if (!auxiliary.level_from_body) return;
  const Eigen::Vector3d seen = odometer->state().pose.linear() * up_in_body(auxiliary);
  attitudes = std::min(attitudes + 1, kAttitudes);
  up = (up + (seen - up) / attitudes).normalized();
}

void Tracker::State::start(const PreparedScan& scan) {
  const Pose here = check.last().map_from_body;
  odometer->start(time.now(), scan, {here, Vector6::Zero()});
  check.restart(here, time.now());
  state = TrackingState::kInitialising;
}

Attempt Tracker::State::align_or_retry(const PreparedScan& scan, const MotionPrior& prior) {
  if (check.distrusted_scans() > 0) return odometer->probe(scan, prior, Reach::kNear);
  Attempt best = odometer->align(scan, prior, Reach::kNear);
  // After a gap the heading may be another, and rooms look alike in several headings.
  if (explains(best, kFitScore) && (unseen_s() < kMoment || has_usual_inlier_ratio(best.health))) return best;
  // The far reach takes long, so it is done with part of the points: the next scan must not wait.
  const PreparedScan part = part_of(scan, kLookPoints);
  MotionPrior loose = loosened(prior);
  Attempt far = odometer->look_far(part, loose);
  far.prior = prior;
  if (explains(far, kJumpScore) && check.is_plausible(far)) {
    loose.mean = far.alignment.moving;
    Attempt again = odometer->align(scan, loose, Reach::kNear);
    again.prior = prior;
    // On new ground the cost is higher than before, and some implausible motion always has a lower one.
    if (check.is_plausible(again)) best = better(std::move(best), std::move(again));
  }
  return best;
}

void Tracker::State::track_on(const PreparedScan& scan, const ScanPrior& auxiliary, TrackedScan* tracked) {
  MotionPrior prior = predict();
  if (odometer->awaits_second()) {  // no motion follows from two scans if the sensor was covered at one
    const double more = odometer->for_one_of_first(scan);
    if (more < kCovered || more * kCovered > 1) {
      describe({}, PoseMethod::kPredicted, tracked);
      distrust(prior);
      if (more > 1 || check.distrusted_scans() >= kFalseStarts) start(scan);
      return;
    }
  }
  Attempt attempt = odometer->deskew_first(scan, time.elapsed_s(), align_or_retry(scan, prior), true);
  // Auxiliary odometry decides only where the scans do not suffice.
  const MotionPrior expected = auxiliary.motion ? predict(auxiliary) : prior;
  if (auxiliary.motion && !check.is_trusted(attempt)) {
    prior = expected;
    Attempt hinted = odometer->align(scan, prior, Reach::kNear);
    if (check.is_trusted(hinted)) attempt = std::move(hinted);
  }
  const bool fits = check.is_trusted(attempt);
  const bool kidnapped = fits && check.is_kidnapped(time.now(), scan, expected, attempt);
  finished(Stage::kAlign);
  if (fits && !kidnapped) {
    if (auxiliary.motion) attempt.told = expected.mean;
    trust(scan, attempt);
    describe(attempt, PoseMethod::kIcp, tracked);
    return;
  }
  describe(attempt, PoseMethod::kPredicted, tracked);
  distrust(prior, kidnapped);
  if (state == TrackingState::kInitialising) {
    if (check.distrusted_scans() >= kFalseStarts) start(scan);
    return;
  }
  relocalisation.distrust(time.now(), time.elapsed_s(), scan, *odometer, attempt.health.energy);
  if (relocalisation.lost() && open) begin_submap(scan, tracked);
}

void Tracker::State::trust(const PreparedScan& scan, const Attempt& attempt) {
  odometer->accept(attempt);
  open = unknown_axes(odometer->pose_covariance(), kHorizontal, kSamePlace) != 0;
  // The next scan is not compared with one that the map explains little of: a crowd or dust may be gone.
  check.trust(time.now(), scan, odometer->state(), attempt.health.inlier_ratio >= kDegradedShare);
  state = TrackingState::kTracking;
  if (loose_since && time.since_s(*loose_since) > config.new_map_after_s) begin_epoch();
  relocalisation.end();
  keep(scan, attempt.health.inlier_ratio);
}

void Tracker::State::begin_epoch() {
  ++epoch;
  loose_since.reset();
}

void Tracker::State::keep(const PreparedScan& scan, double share) {
  read_map([&] { given_ground.follow(archive, scale.current(0), odometer.get()); });
  odometer->keep(time.now(), scan, share);
  const Pose& here = odometer->state().pose;
  if (archive.wants(time.now(), here.translation(), scan.median_range))
    archive.add(time.now(), here, scan.median_range, deskewed(scan.source, odometer->state()), constraint());
  archive.note_body_up(here);
}

std::optional<Constraint> Tracker::State::constraint() {
  const Matrix6 drift = odometer->take_new_drift();
  if (archive.empty()) return std::nullopt;
  const Pose& here = odometer->state().pose;
  const ArchivedKeyframe& before = jumped ? archive.nearest(here.translation()) : archive.keyframes().back();
  const Matrix6 covariance = jumped ? odometer->pose_covariance() : drift;
  jumped = false;
  return constraint_to(before, here, covariance);
}

void Tracker::State::jump(const Pose& from, const Pose& to) {
  local_from_own = renormalised(local_from_own * from * to.inverse());
}

void Tracker::State::distrust(const MotionPrior& prior, bool kidnapped) {
  check.distrust(kidnapped);
  coast(prior);
  if (state != TrackingState::kInitialising && !relocalisation.lost() && check.distrusted_scans() > 1) lose();
}

void Tracker::State::coast(const MotionPrior& prior) {
  odometer->coast(prior);
  const bool long_ago = unseen_s() > kCoastSeconds;
  if (long_ago) odometer->stand();
  if (state == TrackingState::kInitialising || relocalisation.lost()) return;
  state = TrackingState::kDegraded;
  if (long_ago) lose();
}

}  // namespace scanlock
