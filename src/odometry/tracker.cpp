// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/moved_cloud.hpp"
#include "odometry/alignment_check.hpp"
#include "odometry/given_ground.hpp"
#include "odometry/join.hpp"
#include "odometry/odometer.hpp"
#include "odometry/relocalisation.hpp"
#include "odometry/scan_preparation.hpp"
#include "odometry/timeline.hpp"
#include "odometry/tracking_promise.hpp"

namespace scanlock {
namespace {

constexpr std::uint32_t kOutOfPlane = 0b011100;  // z, roll, pitch: see Degeneracy
constexpr std::uint32_t kHorizontal = 0b000011;  // x, y

constexpr double kDegradedShare = 0.4;  // inlier ratio: with a lower one a scan is DEGRADED
constexpr int kAttitudes = 100;         // over which the upward direction is averaged
constexpr double kCovered = 0.5;        // least ratio of the numbers of points of the first two scans
constexpr int kFalseStarts = 3;         // scans that do not fit the first one, which is then replaced

Eigen::Vector3d up_in_body(const ScanPrior& auxiliary) {
  return auxiliary.level_from_body->conjugate() * Eigen::Vector3d::UnitZ();
}

}  // namespace

struct Tracker::State {
  TrackerConfig config;
  std::function<void(Stage)> observer;

  VoxelScale scale;
  std::unique_ptr<Odometer> odometer;
  KeyframeArchive archive;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // upward direction, own frame
  int attitudes = 0;                              // number of which `up` is the mean

  TrackingState state = TrackingState::kInitialising;
  std::uint32_t epoch = 0;
  double moved_away = 0;     // metres along -x by which earlier submaps were moved when the last one began
  std::uint32_t submap = 0;  // index of the active submap, from 0
  Timeline time;
  bool begun = false;  // a scan with enough points came in
  // All poses of the state are in the own frame, that of the first scan, so that the result does not depend
  // on the origin and heading of the map's frame. Inputs and outputs are transformed.
  Pose map_from_own = Pose::Identity();
  Pose local_from_own = Pose::Identity();
  bool jumped = false;           // the pose in the own frame jumped since the last keyframe was archived
  std::int64_t reloaded_at = 0;  // when the local map was reloaded from the archive; microseconds

  AlignmentCheck check;
  // At the last trusted scan the position along x or y was not known, as in a tunnel: a robot that is then
  // lost cannot be relocalised at one place. Where only the heading was unknown, behind a cover, it can.
  bool open = false;
  // When the active submap began with an open position: until it is joined its poses are as uncertain as that
  // position was. After new_map_after_s they are those of a new epoch.
  std::optional<std::int64_t> loose_since;
  std::string map_fault;  // to be reported with the next scan
  GivenGround given_ground;

  Relocalisation relocalisation;

  explicit State(const TrackerConfig& c)
      : config(c),
        scale(c.map_points_per_scan, c.min_voxel_m, c.max_voxel_m),
        odometer(std::make_unique<Odometer>(c)),
        archive(static_cast<std::size_t>(c.max_archive_points)),
        relocalisation(c) {}

  void finished(Stage stage) const {
    if (observer) observer(stage);
  }

  // ---- tracking

  /// Crops and thins the scan; one with too few points is reported as empty.
  PreparedScan prepare(const Scan& scan, TrackedScan* tracked) {
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

  /// The predicted state at this scan: by the velocity, or by the motion that another sensor measured.
  MotionPrior predict(const ScanPrior& auxiliary = {}) const {
    const auto after = [&](double seconds) {
      return auxiliary.motion ? odometer->predict(seconds, *auxiliary.motion) : odometer->predict(seconds);
    };
    MotionPrior prior = after(time.elapsed_s());
    if (time.most_elapsed_s() > time.elapsed_s())
      prior.information = after(time.most_elapsed_s()).information;
    return prior;
  }

  /// Updates the mean upward direction of the map with the attitude at a trusted scan.
  void note_attitude(const ScanPrior& auxiliary) {
    if (!auxiliary.level_from_body) return;
    const Eigen::Vector3d seen = odometer->state().pose.linear() * up_in_body(auxiliary);
    attitudes = std::min(attitudes + 1, kAttitudes);
    up = (up + (seen - up) / attitudes).normalized();
  }

  /// The scan becomes the map.
  void start(const PreparedScan& scan) {
    const Pose here = check.last().map_from_body;
    odometer->start(time.now(), scan, {here, Vector6::Zero()});
    check.restart(here, time.now());
    state = TrackingState::kInitialising;
  }

  /// Aligns from the prediction. Where that does not explain the scan: once more with a loosened prior and
  /// the far reach.
  Attempt align_or_retry(const PreparedScan& scan, const MotionPrior& prior) {
    if (check.distrusted_scans() > 0) return odometer->probe(scan, prior, Reach::kNear);
    Attempt best = odometer->align(scan, prior, Reach::kNear);
    // After a gap the heading may be another, and rooms look alike in several headings.
    if (explains(best, kFitScore) && (unseen_s() < kMoment || has_usual_inlier_ratio(best.health)))
      return best;
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

  /// Seconds since the last trusted scan.
  double unseen_s() const { return check.unseen_s(time.now()); }

  /// A scan of a robot that is not lost: predict, align, decide, fuse.
  void track_on(const PreparedScan& scan, const ScanPrior& auxiliary, TrackedScan* tracked) {
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
    const bool contradicted = fits && check.is_contradicted(time.now(), scan, attempt);
    // (With a planar sensor a search is no confirmation.)
    const bool unconfirmed = fits && !contradicted && !scan.planar &&
                             check.is_to_be_confirmed(time.now(), time.period_s(), expected, attempt);
    finished(Stage::kAlign);
    if (fits && !contradicted && !unconfirmed) {
      if (auxiliary.motion) attempt.told = expected.mean;
      trust(scan, attempt);
      describe(attempt, PoseMethod::kIcp, tracked);
      return;
    }
    describe(attempt, PoseMethod::kPredicted, tracked);
    // The alignment is still likelier than the prediction; local relocalisation begins there.
    if (unconfirmed) prior.mean = attempt.alignment.moving;
    distrust(prior, contradicted || unconfirmed);
    if (unconfirmed && !relocalisation.lost()) lose();
    if (state == TrackingState::kInitialising) {
      if (check.distrusted_scans() >= kFalseStarts) start(scan);
      return;
    }
    relocalisation.distrust(time.now(), time.elapsed_s(), scan, *odometer, attempt.health.energy);
    if (relocalisation.lost() && open) begin_submap(scan, tracked);
  }

  void trust(const PreparedScan& scan, const Attempt& attempt) {
    odometer->accept(attempt);
    open = unknown_axes(odometer->pose_covariance(), kHorizontal, kSamePlace) != 0;
    // The next scan is not compared with one that the map explains little of: a crowd or dust may be gone.
    check.trust(time.now(), scan, odometer->state(), attempt.health.inlier_ratio >= kDegradedShare);
    state = TrackingState::kTracking;
    if (loose_since && time.since_s(*loose_since) > config.new_map_after_s) begin_epoch();
    relocalisation.end();
    keep(scan, attempt.health.inlier_ratio);
  }

  /// From here on poses are in another frame, relative to which they are not uncertain.
  void begin_epoch() {
    ++epoch;
    loose_since.reset();
  }

  void keep(const PreparedScan& scan, double share) {
    read_map([&] { given_ground.follow(archive, scale.current(0), odometer.get()); });
    odometer->keep(time.now(), scan, share);
    const Pose& here = odometer->state().pose;
    if (archive.wants(time.now(), here.translation(), scan.median_range))
      archive.add(time.now(), here, scan.median_range, deskewed(scan.source, odometer->state()),
                  constraint());
    archive.note_body_up(here);
  }

  /// The constraint of a new keyframe: by odometry, to the keyframe before it; after a jump, by the alignment
  /// of this scan, to the nearest keyframe.
  std::optional<Constraint> constraint() {
    const Matrix6 drift = odometer->take_new_drift();
    if (archive.empty()) return std::nullopt;
    const Pose& here = odometer->state().pose;
    const ArchivedKeyframe& before =
        jumped ? archive.nearest(here.translation()) : archive.keyframes().back();
    const Matrix6 covariance = jumped ? odometer->pose_covariance() : drift;
    jumped = false;
    return constraint_to(before, here, covariance);
  }

  /// The pose in the own frame changed otherwise than by motion: keeps the local frame free of jumps.
  void jump(const Pose& from, const Pose& to) {
    local_from_own = renormalised(local_from_own * from * to.inverse());
  }

  /// The prediction stands in for a scan that is not trusted; after two such scans in a row the robot is
  /// lost.
  void distrust(const MotionPrior& prior, bool contradicted = false) {
    check.distrust(contradicted);
    coast(prior);
    if (state != TrackingState::kInitialising && !relocalisation.lost() && check.distrusted_scans() > 1)
      lose();
  }

  /// The prediction stands in for a scan without points.
  void coast(const MotionPrior& prior) {
    odometer->coast(prior);
    const bool long_ago = unseen_s() > kCoastSeconds;
    if (long_ago) odometer->stand();
    if (state == TrackingState::kInitialising || relocalisation.lost()) return;
    state = TrackingState::kDegraded;
    if (long_ago) lose();
  }

  // ---- lost

  /// A scan of a lost robot: followed by lost-mode odometry until it is relocalised, or begins a submap.
  void track_lost(const PreparedScan& scan, const ScanPrior& auxiliary, TrackedScan* tracked) {
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

  /// The map of lost-mode odometry becomes the active submap. Where the position was open, the pose has not
  /// jumped, and stays as uncertain as before.
  void begin_submap(const PreparedScan& scan, TrackedScan* tracked) {
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

  void lose() { relocalisation.begin(*odometer, check.last(), check.looks_alike(), archive); }

  /// Where `work` cannot read stored points, the local map stays as it is.
  template <typename Work>
  void read_map(const Work& work) {
    try {
      work();
    } catch (const PointsUnreadable& error) {
      map_fault = error.what();
    }
  }

  /// The local map becomes the archived keyframes around `centre`.
  void reload(const Eigen::Vector3d& centre) {
    read_map([&] {
      odometer->reload(archive.keyframes(), centre, scale.current(0), archive.fixed());
      reloaded_at = time.now();
    });
  }

  // ---- reporting

  void describe(const Attempt& attempt, PoseMethod method, TrackedScan* tracked) const {
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

  TrackingState reported_state() const { return relocalisation.lost() ? relocalisation.state() : state; }

  void report(TrackedScan* tracked) {
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
};

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
