// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/moved_cloud.hpp"
#include "odometry/join.hpp"
#include "odometry/odometer.hpp"
#include "odometry/relocation.hpp"
#include "odometry/scan_clock.hpp"
#include "odometry/scan_preparation.hpp"
#include "odometry/tracking_promise.hpp"

namespace scanlock {
namespace {

constexpr double kMicro = 1e-6;

constexpr std::uint32_t kOutOfPlane = 0b011100;  // z, roll, pitch: see Degeneracy
// From the prediction the far look reaches where the robot was last seen, when that is within this share of
// the median range, and this turn.
constexpr double kWithinReach = 0.08, kWithinTurn = 5.0 * kDegree;
constexpr double kUnusualGap = 10;  // what kMostGap is, for a robot that is not trusted
constexpr double kStrayGap =
    1;  // lorries close by have 0.5, kidnaps that nothing else tells of mostly 6 and more
constexpr double kDegradedShare = 0.4;            // of the points of a scan: fewer are explained
constexpr int kQuietScans = 5;                    // after that, before the map may grow
constexpr int kAttitudes = 100;                   // that the upward direction is averaged over
constexpr std::int64_t kAnotherRun = 3600000000;  // microseconds
constexpr double kCovered = 0.5;  // of the first two scans: one has so few points for the other
constexpr int kFalseStarts = 3;   // scans that do not fit the first one: it was no good

Eigen::Vector3d up_in_body(const ScanPrior& hints) {
  return hints.level_from_body->conjugate() * Eigen::Vector3d::UnitZ();
}

}  // namespace

struct Tracker::State {
  TrackerConfig config;
  std::function<void(Stage)> observer;

  VoxelScale scale;
  std::unique_ptr<Odometer> odometer;
  KeyframeArchive archive;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // in the map frame
  int attitudes = 0;                              // that `up` is the mean of

  TrackingState state = TrackingState::kInitialising;
  std::uint32_t epoch = 0;
  double moved_away = 0;     // metres along x, the submaps before it
  std::uint32_t submap = 0;  // counts those that the robot began
  ScanClock clock;
  std::int64_t last_utime = 0;  // stamp
  // Microseconds that advance whatever the stamps do; they are the stamps, until the clock steps.
  std::int64_t now = 0;
  double dt = 0, most_dt = 0;  // seconds since the scan before: a guess, and at most, where the clock stepped
  bool timed = false, begun = false;
  // Everything below works in a frame of its own, that of the first scan: where the map has its origin, and
  // how it is turned, must not matter. What goes in and out is moved.
  Pose map_from_own = Pose::Identity();
  Pose start_pose = Pose::Identity();  // of the first scan, in the own frame
  Pose local_from_own = Pose::Identity();
  bool jumped = false;  // in it, since the last keyframe was archived

  Sighting last_trusted;
  int distrusted_scans = 0;  // in a row
  bool open = false;  // before them its place was not known, as in a tunnel: there is none to come back to
  bool looks_alike = false;  // one of them fits, but the last trusted one says that it is of another place
  int quiet_scans_left = 0;
  std::string map_fault;  // to be told with the next scan

  Relocation relocation;

  explicit State(const TrackerConfig& c)
      : config(c),
        scale(c.map_points_per_scan, c.min_voxel_m, c.max_voxel_m),
        odometer(std::make_unique<Odometer>(c)),
        archive(static_cast<std::size_t>(c.max_archive_points)),
        relocation(c) {}

  void finished(Stage stage) const {
    if (observer) observer(stage);
  }

  // ---- on known ground

  /// Where the robot should be by now: by its velocity, or by what its odometry says it has moved.
  MotionPrior predict(const ScanPrior& hints = {}) const {
    const auto after = [&](double seconds) {
      return hints.motion ? odometer->predict(seconds, *hints.motion) : odometer->predict(seconds);
    };
    MotionPrior prior = after(dt);
    if (most_dt > dt) prior.information = after(most_dt).information;
    return prior;
  }

  /// Takes the stamp of a scan; false where it is not one of the clock.
  bool take_time(const Scan& scan, TrackedScan* tracked) {
    const ScanClock::Reading reading = clock.read(scan);
    if (!clock.accepts(reading.verdict)) {
      tracked->verdict = reading.verdict == ScanClock::Verdict::kDuplicate  ? ScanVerdict::kDuplicateTime
                         : reading.verdict == ScanClock::Verdict::kBackward ? ScanVerdict::kBackwardTime
                                                                            : ScanVerdict::kOtherClock;
      tracked->why = std::string(to_string(tracked->verdict)) + ", the scan before it has " +
                     std::to_string(reading.last_utime) +
                     (scan.stamped_by_arrival ? "; it has no stamp" : "");
      tracked->interleaved = reading.interleaved;
      return false;
    }
    if (reading.verdict == ScanClock::Verdict::kStepped) tracked->clock_step_from = reading.last_utime;
    now = !timed ? std::max(now, scan.utime)
                 : now + static_cast<std::int64_t>(std::llround(reading.most_elapsed_s / kMicro));
    timed = true;
    last_utime = scan.utime;
    dt = begun ? reading.elapsed_s : 0.0;
    most_dt = begun ? reading.most_elapsed_s : 0.0;
    return true;
  }

  /// Keeps which way is up in the map, from the attitudes that come with trusted scans.
  void note_attitude(const ScanPrior& hints) {
    if (!hints.level_from_body) return;
    const Eigen::Vector3d seen = odometer->state().pose.linear() * up_in_body(hints);
    attitudes = std::min(attitudes + 1, kAttitudes);
    up = (up + (seen - up) / attitudes).normalized();
  }

  void start(const PreparedScan& scan) {
    odometer->start(now, scan, {start_pose, Vector6::Zero()});
    last_trusted = Sighting();
    last_trusted.map_from_body = start_pose;
    last_trusted.utime = now;
    distrusted_scans = 0;
    state = TrackingState::kInitialising;
  }

  /// The prior is strong where the robot does what it did; where that does not explain the scan, it is let go
  /// once and a wider kernel tried, from the prediction and from where the robot was last seen.
  Attempt align_or_retry(const PreparedScan& scan, const MotionPrior& prior) {
    if (distrusted_scans > 0) return odometer->probe(scan, prior, Reach::kNear);
    Attempt best = odometer->align(scan, prior, Reach::kNear);
    // After a gap the heading may be another, and rooms look alike once turned.
    if (explains(best, kFitScore) && (unseen_s() < kMoment || usual_share(best.health))) return best;
    // A far look is dear, and a part of the points will do for it: the next scan must not wait.
    const PreparedScan part = part_of(scan, kLookPoints);
    MotionPrior loose = loosened(prior);
    Attempt far = odometer->look_far(part, loose);
    const bool moved =
        !near(prior.mean.pose, last_trusted.map_from_body, kWithinReach * scan.median_range, kWithinTurn);
    if (moved && !explains(far, kJumpScore)) {
      loose.mean = {last_trusted.map_from_body, Vector6::Zero()};
      far = better(std::move(far), odometer->look_far(part, loose));
    }
    far.prior = prior;
    if (explains(far, kHopelessScore) && plausible(far)) {
      loose.mean = far.alignment.moving;
      Attempt again = odometer->align(scan, loose, Reach::kNear);
      again.prior = prior;
      // A scan of new ground costs more than its like did, and some motion that nobody makes always costs
      // less.
      if (plausible(again)) best = better(std::move(best), std::move(again));
    }
    return best;
  }

  /// Seconds since a scan was trusted.
  double unseen_s() const { return kMicro * static_cast<double>(now - last_trusted.utime); }

  static double gap(const Attempt& attempt) { return squared_gap(attempt.prior, attempt.alignment.moving); }

  /// Whether the robot can have come there, as far as its motion is known: a place that explains the scan may
  /// be another that looks the same. Where much of the scan is left unexplained, by new ground or by another
  /// place, it has to be where it was predicted.
  bool plausible(const Attempt& attempt) const {
    if (gap(attempt) > (distrusted_scans > 0 ? kUnusualGap : kMostGap)) return false;
    const Matrix6 covariance = pose_covariance(attempt.prior);
    const double metres = std::sqrt(covariance.diagonal().head<3>().maxCoeff());
    const double radians = std::sqrt(covariance.diagonal().segment<3>(3).maxCoeff());
    const Pose &found = attempt.alignment.moving.pose, &predicted = attempt.prior.mean.pose;
    if (usual_share(attempt.health))
      return near(found, predicted, 1.0 + 5.0 * metres, 10.0 * kDegree + 5.0 * radians);
    return near(found, predicted, 0.1 + 2.0 * metres, 2.0 * kDegree + 2.0 * radians);
  }

  bool trusted(const Attempt& attempt) const {
    const bool wary = distrusted_scans > 0 && state != TrackingState::kInitialising;
    if (explains(attempt, wary ? kCalmScore : kJumpScore)) return plausible(attempt);
    // At the edge of new ground a scan costs more, though all of it is there and nothing moved in any other
    // way.
    return !wary && explains(attempt, kHopelessScore) && usual_share(attempt.health) &&
           gap(attempt) < kUnusualGap;
  }

  /// Another place explains a scan about as well at times, but does not look the same in every direction from
  /// one scan to the next. What passes close by hides as much, but neither puts the robot aside of its way
  /// nor costs much. After a gap the motion says little of where it can be, and this test alone tells a
  /// kidnap: gaps of 0.6 to 2.2 s in streets, rooms and woods left at most 0.03, kidnaps in a gap of 0.5 s
  /// 0.37 to 0.49. The motion of the first few scans is not known well enough to say.
  bool only_looks_alike(const PreparedScan& scan, const Attempt& attempt) const {
    const bool after_gap = unseen_s() > kMoment;
    const double most = after_gap ? kMostContradictionAfterGap : kMostContradiction;
    const bool strange = after_gap || looks_alike || gap(attempt) > kStrayGap ||
                         attempt.health.score > kCalmScore || !usual_share(attempt.health);
    return strange && !attempt.health.young &&
           contradiction(last_trusted, now, scan, attempt.alignment.moving) > most;
  }

  void track_on(const PreparedScan& scan, const ScanPrior& hints, TrackedScan* tracked) {
    MotionPrior prior = predict();
    if (odometer->awaits_second()) {  // of a pair of which one is covered the motion of neither follows
      const double more = odometer->for_one_of_first(scan);
      if (more < kCovered || more * kCovered > 1) {
        describe({}, PoseMethod::kPredicted, tracked);
        coast(prior);
        if (more > 1 || distrusted_scans >= kFalseStarts) start(scan);
        return;
      }
    }
    Attempt attempt = odometer->deskew_first(scan, dt, align_or_retry(scan, prior), true);
    if (hints.motion && !trusted(attempt)) {  // what others say is asked where the scans do not suffice
      prior = predict(hints);
      Attempt hinted = odometer->align(scan, prior, Reach::kNear);
      if (trusted(hinted)) attempt = std::move(hinted);
    }
    const bool fits = trusted(attempt);
    const bool alike = fits && only_looks_alike(scan, attempt);
    finished(Stage::kAlign);
    if (fits && !alike) {
      if (hints.motion) attempt.told = predict(hints).mean;
      believe(scan, attempt);
      describe(attempt, PoseMethod::kIcp, tracked);
      return;
    }
    looks_alike = looks_alike || alike;
    describe(attempt, PoseMethod::kPredicted, tracked);
    coast(prior);
    if (state == TrackingState::kInitialising) {
      if (distrusted_scans >= kFalseStarts) start(scan);
      return;
    }
    relocation.distrust(now, dt, scan, *odometer, attempt.health.energy);
    if (relocation.lost() && open) begin_submap(scan, tracked);
  }

  void believe(const PreparedScan& scan, const Attempt& attempt) {
    odometer->accept(attempt);
    distrusted_scans = 0;
    looks_alike = false;
    open = unknown_axes(odometer->pose_covariance(), kOnTheGround, kSamePlace, kSameHeading) != 0;
    last_trusted = sighting(now, scan, odometer->state());
    // What the map explains little of, a crowd or dust, may be gone the next moment.
    if (attempt.health.share < kDegradedShare) last_trusted.rays = {};
    state = TrackingState::kTracking;
    relocation.end();
    if (quiet_scans_left > 0) {
      --quiet_scans_left;
      return;
    }
    odometer->keep(now, scan, attempt.health.share);
    if (archive.wants(now, last_trusted.map_from_body.translation(), scan.median_range))
      archive.add(now, last_trusted.map_from_body, scan.median_range,
                  deskewed(scan.source, odometer->state()), tie());
    archive.note_stand(last_trusted.map_from_body);
  }

  /// By odometry to the keyframe before; after a jump by the alignment of now to the one nearest by.
  std::optional<Constraint> tie() {
    const Matrix6 drift = odometer->take_new_drift();
    if (archive.empty()) return std::nullopt;
    const Pose& here = odometer->state().pose;
    const ArchivedKeyframe& before =
        jumped ? archive.nearest(here.translation()) : archive.keyframes().back();
    const Matrix6 covariance = jumped ? odometer->pose_covariance() : drift;
    jumped = false;
    return tie_to(before, here, covariance);
  }

  /// Poses in the map went from one to another without any motion.
  void jump(const Pose& from, const Pose& to) {
    local_from_own = renormalised(local_from_own * from * to.inverse());
  }

  /// Nothing was learnt: the prediction stands in, and is not believed for long.
  void coast(const MotionPrior& prior) {
    coast_blind(prior);
    ++distrusted_scans;
    if (state != TrackingState::kInitialising && !relocation.lost() && distrusted_scans > 1) lose();
  }

  /// The same where there is nothing to learn from, as in a gap between scans.
  void coast_blind(const MotionPrior& prior) {
    odometer->coast(prior);
    const bool long_ago = unseen_s() > kCoastSeconds;
    if (long_ago) odometer->stand();
    if (state == TrackingState::kInitialising || relocation.lost()) return;
    state = TrackingState::kDegraded;
    if (long_ago) lose();
  }

  // ---- lost

  void track_lost(const PreparedScan& scan, const ScanPrior& hints, TrackedScan* tracked) {
    if (!relocation.has_excursion()) coast(predict());
    Attempt attempt;
    const Relocation::Outcome outcome = relocation.follow(now, dt, scan, *odometer, &attempt);
    if (hints.level_from_body) relocation.note_up(up_in_body(hints));
    finished(Stage::kAlign);
    if (outcome == Relocation::Outcome::kLost) {
      if (relocation.gives_up() || open)
        begin_submap(scan, tracked);
      else
        describe(attempt, PoseMethod::kPredicted, tracked);
      return;
    }
    const bool found = outcome == Relocation::Outcome::kFound;
    if (found) ++epoch;
    // On new ground it must grow at once, or the robot has left it.
    quiet_scans_left = usual_share(attempt.health) ? kQuietScans : 0;
    // The next scans cost what this one does: in a map of archived keyframes, which are thinner, or on new
    // ground that is more than before.
    if (!explains(attempt, kCalmScore)) odometer->forget_usual();
    const Pose predicted = relocation.excursion().state().pose;
    join(relocation.excursion(), renormalised(attempt.alignment.moving.pose * predicted.inverse()),
         scan.median_range, &archive);
    if (relocation.map_of_several()) reload(attempt.alignment.moving.pose.translation());
    jumped = true;
    believe(scan, attempt);
    jump(predicted, odometer->state().pose);
    describe(attempt, found ? PoseMethod::kGlobal : PoseMethod::kIcp, tracked);
  }

  /// What was seen since the robot got lost is its map from now on. Where its pose was open it has not
  /// jumped: that is as uncertain as before.
  void begin_submap(const PreparedScan& scan, TrackedScan* tracked) {
    Excursion& excursion = relocation.excursion();
    const Matrix6 uncertain = odometer->pose_covariance() + odometer->drift();
    moved_away = archive.begin_submap(excursion.seen());
    describe(excursion.attempt(), PoseMethod::kIcp, tracked);
    odometer = excursion.take_odometer();
    relocation.end();
    ++submap;
    if (open)
      odometer->set_drift(uncertain);
    else
      ++epoch;
    attitudes = 0;
    up = Eigen::Vector3d::UnitZ();
    jumped = looks_alike = false;
    distrusted_scans = quiet_scans_left = 0;
    last_trusted = sighting(now, scan, odometer->state());
    state = TrackingState::kTracking;
  }

  void lose() { relocation.begin(*odometer, last_trusted, looks_alike, archive); }

  /// The local map becomes what is archived around there; it stays where that cannot be read.
  void reload(const Eigen::Vector3d& centre) {
    try {
      odometer->reload(archive.keyframes(), {centre}, scale.current(0));
    } catch (const PointsUnreadable& error) {
      map_fault = error.what();
    }
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

  TrackingState reported_state() const { return relocation.lost() ? relocation.state() : state; }

  void report(TrackedScan* tracked) {
    tracked->state = reported_state();
    if (tracked->state == TrackingState::kTracking) {
      const std::uint32_t never = odometer->planar() ? kOutOfPlane : 0;  // seen, nor missed, by such a sensor
      const std::uint32_t missing = unknown_axes(odometer->pose_covariance(), ~never);
      tracked->degenerate_axes = missing | never;
      const bool little = tracked->inliers < kDegradedShare * tracked->points_used;
      if (missing != 0 || little) tracked->state = TrackingState::kDegraded;
    }
    tracked->epoch = epoch;
    tracked->map_from_body = map_from_own * odometer->state().pose;
    tracked->local_from_body = local_from_own * odometer->state().pose;
    tracked->twist = odometer->state().twist;
    tracked->covariance = odometer->pose_covariance() + odometer->drift();
    tracked->keyframes = static_cast<int>(odometer->map().keyframes().size());
    tracked->map_points = static_cast<int>(odometer->map().size());
    tracked->map_fault = std::exchange(map_fault, {});
    tracked->recovery = relocation.take_ended();
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

TrackedScan Tracker::track(const Scan& scan, const ScanPrior& hints) {
  TrackedScan tracked;
  tracked.utime = scan.utime;
  tracked.points_in = static_cast<int>(scan.points.size());
  State& s = *state_;
  if (!s.take_time(scan, &tracked)) {
    tracked.state = s.reported_state();
    return tracked;
  }

  const double min_range = is_planar(scan.points) ? s.config.planar_min_range_m : s.config.min_range_m;
  const CroppedScan cropped = crop(scan.points, min_range, s.config.max_range_m);
  const PreparedScan prepared =
      thin_scan(scan.points, cropped, &s.scale, !s.begun, s.config.max_source_points);
  tracked.points_used = static_cast<int>(prepared.source.size());
  s.finished(Stage::kPreprocess);
  const bool seen = prepared.source.size() >= kLeastPoints;
  if (!seen) {
    tracked.verdict = ScanVerdict::kEmpty;
    tracked.why = why_too_few(scan.points, cropped, min_range, s.config.max_range_m);
  }
  if (!seen && !s.begun) return tracked;

  if (!s.begun) {
    if (s.relocation.lost()) {
      s.odometer->set_planar(prepared.planar);
      s.relocation.distrust(s.now, 0, prepared, *s.odometer, 1);
      tracked.method = PoseMethod::kPredicted;
    } else {
      s.start(prepared);
    }
    s.begun = true;
  } else if (!seen) {
    if (s.relocation.has_excursion()) {
      s.relocation.coast(s.dt, *s.odometer);
    } else {
      s.coast_blind(s.predict(hints));
    }
    tracked.method = PoseMethod::kPredicted;
    tracked.stop_reason = StopReason::kTooFewPoints;
  } else if (s.relocation.lost()) {
    s.track_lost(prepared, hints, &tracked);
  } else {
    s.track_on(prepared, hints, &tracked);
  }
  if (tracked.method == PoseMethod::kIcp && !s.relocation.lost()) s.note_attitude(hints);
  s.report(&tracked);
  s.finished(Stage::kMap);
  return tracked;
}

std::optional<RecoveryRequest> Tracker::take_request() {
  const State& s = *state_;
  // Of a submap begun later it is not known how that one stands to this.
  const bool is_one_map = s.submap == 0;
  const auto up = s.attitudes > 0 && is_one_map ? std::optional<Eigen::Vector3d>(s.up) : std::nullopt;
  return state_->relocation.take_request(s.last_utime, s.archive, up);
}

void Tracker::give(RecoveryAnswer answer) {
  State& s = *state_;
  note_map_fault(answer.map_fault);
  try {
    s.relocation.give(std::move(answer), s.archive, s.scale.current(0), *s.odometer);
  } catch (const PointsUnreadable& error) {  // what was found cannot be tried; the search goes on
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
  ++s.epoch;
  s.relocation.end();
  const Pose before = s.odometer->state().pose;
  if (s.archive.empty()) s.map_from_own = upright(map_from_body);
  const Pose here = renormalised(s.map_from_own.inverse() * map_from_body);
  s.odometer->set_pose(here);
  s.jump(before, here);
  s.jumped = true;
  s.start_pose = here;
  s.last_trusted = Sighting();
  s.last_trusted.map_from_body = here;
  s.last_trusted.utime = s.now;
  s.begun = s.open = false;
  if (!s.archive.knows(here.translation())) {  // a new start
    s.state = TrackingState::kInitialising;
    return;
  }
  s.reload(here.translation());
  s.lose();
  s.relocation.propose_here();
}

SavedMap Tracker::save() const {
  return moved({state_->epoch, state_->last_trusted.map_from_body, state_->archive.keyframes(), {}},
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
  // What was archived is of an earlier run, whatever the clock of either said.
  s.now = std::min(s.archive.keyframes().back().utime, std::numeric_limits<std::int64_t>::max() / 2) +
          kAnotherRun;
  s.start_pose = s.last_trusted.map_from_body = saved.last_pose;
  s.jump(s.odometer->state().pose, saved.last_pose);
  s.jumped = true;
  s.odometer->set_pose(saved.last_pose);
  s.relocation.begin(*s.odometer, std::nullopt, false, s.archive);
}

PointCloud Tracker::map() const {
  return moved(state_->odometer->map().snapshot(), state_->map_from_own);
}

const LocalMap& Tracker::local_map() const {
  return state_->odometer->map();
}
int Tracker::excursion_scans() const {
  return state_->relocation.has_excursion() ? state_->relocation.excursion().scans() : 0;
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
  return state_->state == TrackingState::kTracking && !state_->relocation.lost();
}
std::int64_t Tracker::local_map_utime() const {
  const auto& keyframes = state_->odometer->map().keyframes();
  std::int64_t earliest = state_->now;
  for (const Keyframe& k : keyframes) earliest = std::min(earliest, k.utime);
  return earliest;
}
bool Tracker::planar() const {
  return state_->odometer->planar();
}
double Tracker::voxel() const {
  return state_->scale.current(0);
}
Odometer::Usual Tracker::usual() const {
  return state_->odometer->usual();
}

void Tracker::correct(const std::map<std::uint32_t, Pose>& own_from_keyframe, const Pose& map_from_own,
                      const Matrix6& drift, bool jumps) {
  State& s = *state_;
  s.archive.move(own_from_keyframe);
  s.map_from_own = map_from_own;
  s.odometer->set_drift(drift);
  if (jumps) ++s.epoch;
}

void Tracker::set_map_from_own(const Pose& map_from_own) {
  state_->map_from_own = map_from_own;
}

void Tracker::replace(std::uint32_t gone, std::uint32_t kept) {
  state_->archive.replace(gone, kept);
}

const Matrix6& Tracker::drift() const {
  return state_->odometer->drift();
}

void Tracker::set_drift(const Matrix6& drift) {
  state_->odometer->set_drift(drift);
}

}  // namespace scanlock
