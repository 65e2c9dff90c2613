// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/tracker.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "geometry/moved_cloud.hpp"
#include "odometry/tracker_state.hpp"
#include "odometry/tracking_promise.hpp"

namespace scanlock {
namespace {

constexpr std::uint32_t kOutOfPlane = 0b011100;  // z, roll, pitch: see Degeneracy

}  // namespace

void Tracker::State::describe(const Attempt& attempt, PoseMethod method, TrackedScan* tracked) const {
  const bool aligned = method != PoseMethod::kPredicted;
  tracked->method = method;
  tracked->stop_reason = !aligned                      ? StopReason::kDiverged
                         : attempt.alignment.converged ? StopReason::kConverged
                                                       : StopReason::kIterations;
  tracked->iterations = attempt.alignment.iterations;
  tracked->inliers = attempt.health.inliers;
  tracked->energy = attempt.health.energy;
  tracked->energy_baseline = attempt.health.baseline;
  tracked->energy_score = attempt.health.score;
}

void Tracker::State::report(TrackedScan* tracked) {
  tracked->state = reported_state();
  if (tracked->state == TrackingState::kTracking) {
    const std::uint32_t never = odometer->planar() ? kOutOfPlane : 0;  // axes that it cannot observe
    const std::uint32_t missing = unknown_axes(odometer->pose_covariance(), ~never);
    tracked->degenerate_axes = missing | never;
    const bool little = tracked->inliers < kDegradedShare * tracked->points_used;
    if (missing != 0 || little || loose_since) tracked->state = TrackingState::kDegraded;
  }
  tracked->epoch = epoch;
  tracked->map_from_body = map_from_own * odometer->state().pose;
  tracked->local_from_body = local_from_own * odometer->state().pose;
  tracked->twist = odometer->state().twist;
  tracked->covariance = odometer->pose_covariance() + odometer->drift();
  // The first pose defines the frame, without error, but filters need a covariance that has an inverse.
  if (tracked->state == TrackingState::kInitialising)
    tracked->covariance += kPoseFloor * kPoseFloor * Matrix6::Identity();
  tracked->keyframes = static_cast<int>(odometer->map().keyframes().size());
  tracked->map_points = static_cast<int>(odometer->map().size());
  tracked->map_fault = std::exchange(map_fault, {});
  tracked->recovery = relocalisation.take_ended();
  if (tracked->recovery) {
    tracked->recovery->epoch = epoch;
    tracked->recovery->map_from_body = tracked->map_from_body;
    tracked->recovery->map_from_predicted =
        map_from_own * tracked->recovery->map_from_predicted * map_from_own.inverse();
  }
}

Tracker::Tracker(const TrackerConfig& config) : state_(std::make_unique<State>(config)) {}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

TrackedScan Tracker::track(const Scan& scan, const ScanPrior& auxiliary) {
  TrackedScan tracked;
  tracked.utime = scan.utime;
  tracked.points_in = static_cast<int>(scan.points.size());
  State& s = *state_;
  if (!s.time.take(scan, &tracked)) {
    tracked.state = s.reported_state();
    return tracked;
  }
  const PreparedScan prepared = s.prepare(scan, &tracked);
  const bool seen = tracked.verdict != ScanVerdict::kEmpty;
  if (!seen && !s.begun) return tracked;

  if (!s.begun) {
    if (s.relocalisation.lost()) {
      s.odometer->set_planar(prepared.planar);
      s.relocalisation.distrust(s.time.now(), 0, prepared, *s.odometer, 1);
      tracked.method = PoseMethod::kPredicted;
    } else {
      s.start(prepared);
    }
    s.begun = true;
  } else if (!seen) {
    if (s.relocalisation.has_lost_odometry()) {
      s.relocalisation.coast(s.time.elapsed_s(), *s.odometer);
    } else {
      s.coast(s.predict(auxiliary));
    }
    tracked.method = PoseMethod::kPredicted;
    tracked.stop_reason = StopReason::kTooFewPoints;
  } else if (s.relocalisation.lost()) {
    s.track_lost(prepared, auxiliary, &tracked);
  } else {
    s.track_on(prepared, auxiliary, &tracked);
  }
  if (tracked.method == PoseMethod::kIcp && !s.relocalisation.lost()) s.note_attitude(auxiliary);
  s.report(&tracked);
  s.finished(Stage::kMap);
  return tracked;
}

std::optional<RecoveryRequest> Tracker::take_request() {
  const State& s = *state_;
  // `up` was measured in the first submap; the tilt of other submaps relative to it is not known.
  const bool known = s.attitudes > 0 && s.submap == 0;
  return state_->relocalisation.take_request(s.time.stamp(), s.archive,
                                             known ? std::optional<Eigen::Vector3d>(s.up) : std::nullopt);
}

void Tracker::give(RecoveryAnswer answer) {
  State& s = *state_;
  note_map_fault(answer.map_fault);
  try {
    s.relocalisation.give(std::move(answer), s.archive, s.scale.current(0), *s.odometer);
  } catch (const PointsUnreadable& error) {  // the hypotheses cannot be tested; the search goes on
    note_map_fault(error.what());
  }
}

void Tracker::note_map_fault(const std::string& fault) {
  if (!fault.empty()) state_->map_fault = fault;
}

void Tracker::set_stage_observer(std::function<void(Stage)> observer) {
  state_->observer = std::move(observer);
}

void Tracker::reset() {
  auto fresh = std::make_unique<State>(state_->config);
  fresh->epoch = state_->epoch + 1;
  fresh->observer = state_->observer;
  fresh->local_from_own = state_->local_from_own * state_->odometer->state().pose;
  state_ = std::move(fresh);
}

void Tracker::set_pose(const Pose& map_from_body) {
  State& s = *state_;
  s.begin_epoch();
  s.relocalisation.end();
  const Pose before = s.odometer->state().pose;
  if (s.archive.empty()) s.map_from_own = upright(map_from_body);
  const Pose here = renormalised(s.map_from_own.inverse() * map_from_body);
  s.odometer->set_pose(here);
  s.jump(before, here);
  s.jumped = true;
  s.check.restart(here, s.time.now());
  s.begun = s.open = false;
  if (!s.archive.knows(here.translation())) {  // no map there: a new start
    s.state = TrackingState::kInitialising;
    return;
  }
  s.reload(here.translation());
  s.lose();
  s.relocalisation.propose_here();
}

SavedMap Tracker::save() const {
  return moved({state_->epoch, state_->check.last().map_from_body, state_->archive.keyframes(), {}},
               state_->map_from_own);
}

void Tracker::load(SavedMap saved, bool fixed) {
  reset();
  State& s = *state_;
  s.epoch = std::max(s.epoch, saved.epoch + 1);
  if (saved.keyframes.empty()) return;
  const Pose level(level_rotation(saved.up));
  s.map_from_own = level.inverse() * upright(level * saved.keyframes.front().map_from_body);
  saved = moved(saved, s.map_from_own.inverse());
  note_map_fault(s.archive.restore(std::move(saved.keyframes), fixed));
  s.time.start_after(s.archive.keyframes().back().utime);
  s.check.restart(saved.last_pose, 0);
  s.jump(s.odometer->state().pose, saved.last_pose);
  s.jumped = true;
  s.odometer->set_pose(saved.last_pose);
  s.relocalisation.begin(*s.odometer, std::nullopt, false, s.archive);
}

PointCloud Tracker::map() const {
  return moved(state_->odometer->map().snapshot(), state_->map_from_own);
}

const Odometer& Tracker::odometer() const {
  return *state_->odometer;
}
int Tracker::lost_odometry_scans() const {
  return state_->relocalisation.has_lost_odometry() ? state_->relocalisation.lost_odometry().scans() : 0;
}
double Tracker::moved_away() const {
  return state_->moved_away;
}
std::uint32_t Tracker::submap() const {
  return state_->submap;
}
const KeyframeArchive& Tracker::archive() const {
  return state_->archive;
}
const Pose& Tracker::map_from_own() const {
  return state_->map_from_own;
}
Pose Tracker::map_from_local() const {
  return state_->map_from_own * state_->local_from_own.inverse();
}
const Pose& Tracker::own_from_body() const {
  return state_->odometer->state().pose;
}
bool Tracker::on_known_ground() const {
  return state_->state == TrackingState::kTracking && !state_->relocalisation.lost();
}
std::int64_t Tracker::local_map_utime() const {
  const auto& keyframes = state_->odometer->map().keyframes();
  std::int64_t earliest = state_->time.now();
  for (const Keyframe& k : keyframes)
    if (!k.given) earliest = std::min(earliest, k.utime);
  return std::max(earliest, state_->reloaded_at);
}
double Tracker::voxel() const {
  return state_->scale.current(0);
}

void Tracker::correct(const std::map<std::uint32_t, Pose>& own_from_keyframe, const Pose& map_from_own,
                      const Matrix6& drift, bool jumps) {
  State& s = *state_;
  s.archive.move(own_from_keyframe);
  s.given_ground.forget();
  s.map_from_own = map_from_own;
  s.odometer->set_drift(drift);
  if (jumps) s.begin_epoch();
}

void Tracker::set_map_from_own(const Pose& map_from_own) {
  state_->map_from_own = map_from_own;
}

void Tracker::replace(std::uint32_t gone, std::uint32_t kept) {
  state_->archive.replace(gone, kept);
}

void Tracker::set_drift(const Matrix6& drift) {
  state_->odometer->set_drift(drift);
}

}  // namespace scanlock
