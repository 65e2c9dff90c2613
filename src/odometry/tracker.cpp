// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/voxel_grid.hpp"
#include "icp/degeneracy.hpp"
#include "odometry/contest.hpp"
#include "odometry/excursion.hpp"
#include "odometry/odometer.hpp"
#include "odometry/place_search.hpp"
#include "odometry/scan_preparation.hpp"

namespace scanlock {
namespace {

constexpr double kMicro = 1e-6;
constexpr double kDegree = 3.14159265358979 / 180.0;

// Trust in an alignment. The score of good ones stays below 5 in streets and rooms; a kidnap gives 10 and
// more.
constexpr double kJumpScore = 6.0;
constexpr double kCalmScore = 4.0;      // hysteresis: what a lost tracker must get below
constexpr std::size_t kMostPlaces = 5;  // tried at once
constexpr int kPatience = 20;           // scans in which a lost tracker feels around on each,
constexpr int kSeldom = 5;              // and after that on every fifth
constexpr double kFarGate = 2.0;        // metres: a prediction so far off needs the far reach
constexpr double kNewGroundShare = 0.6, kFitScore = 3.0;
constexpr double kUsualShare = 0.8;  // of the usual share of inliers: less is new ground, or another place
constexpr std::size_t kFarPoints = 800;
constexpr int kQuietScans = 5;   // after that, before the map may grow
constexpr int kAttitudes = 100;  // that the upward direction is averaged over
constexpr int kFalseStarts = 3;  // scans that do not fit the first one: it was no good
constexpr double kCoastSeconds =
    3.0;  // a robot that sees nothing is predicted at its last velocity for so long, then as standing

/// Where the robot may be, while it is lost: to be confirmed by the scans that follow.
struct Candidate {
  Contest contest;
  std::optional<RecoveryAnswer>
      answer;  ///< of the global search; none: felt where it must be if nothing happened
};

PointCloud every_nth(const PointCloud& points, std::size_t n) {
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < points.size(); i += n) indices.push_back(static_cast<std::uint32_t>(i));
  return select(points, indices);
}

}  // namespace

struct Tracker::State {
  TrackerConfig config;
  std::function<void(Stage)> observer;

  VoxelScale scale;
  Odometer odometer;
  KeyframeArchive archive;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // in the map frame
  int attitudes = 0;                              // that `up` is the mean of

  TrackingState state = TrackingState::kInitialising;
  std::uint32_t epoch = 0;
  std::int64_t last_utime = 0;
  bool begun = false;
  Pose start_pose = Pose::Identity();  // of the first scan

  Pose last_trusted_pose = Pose::Identity();
  std::int64_t last_trusted_utime = 0;
  int distrusted_scans = 0;  // in a row
  int quiet_scans_left = 0;

  // While lost:
  std::optional<Excursion> excursion;
  double gate_m = 0, gate_rad = 0;  // how far the prediction may be off where the excursion began
  double energy_before = 1;
  std::optional<Candidate> candidate;
  std::vector<Pose> earlier_finds;  // of this excursion, the newest first
  PlaceSearch search;

  explicit State(const TrackerConfig& c)
      : config(c),
        scale(c.map_points_per_scan, c.min_voxel_m, c.max_voxel_m),
        odometer(c),
        archive(static_cast<std::size_t>(c.max_archive_points)) {}

  void finished(Stage stage) const {
    if (observer) observer(stage);
  }

  bool lost() const {
    return state == TrackingState::kRecovering || state == TrackingState::kAmbiguous ||
           state == TrackingState::kLost;
  }

  // ---- on known ground

  /// Where the robot should be by now: by its velocity, or by what its odometry says it has moved. What is
  /// known of both is the same: an odometry that slips must not weigh more than a velocity that changes.
  MotionPrior predict(double dt, const ScanPrior& hints) const {
    MotionPrior prior = odometer.predict(dt);
    if (!hints.motion || dt <= 0) return prior;
    prior.mean.pose = renormalised(odometer.state().pose * *hints.motion);
    prior.mean.twist = se3_log(*hints.motion) / dt;
    return prior;
  }

  /// Keeps which way is up in the map, from the attitudes that come with trusted scans.
  void note_attitude(const ScanPrior& hints) {
    if (!hints.level_from_body) return;
    const Eigen::Vector3d seen =
        odometer.state().pose.linear() * (hints.level_from_body->conjugate() * Eigen::Vector3d::UnitZ());
    attitudes = std::min(attitudes + 1, kAttitudes);
    up = (up + (seen - up) / attitudes).normalized();
  }

  void start(std::int64_t utime, const PreparedScan& scan) {
    odometer.start(utime, scan, {start_pose, Vector6::Zero()});
    last_trusted_pose = start_pose;
    last_trusted_utime = utime;
    distrusted_scans = 0;
    state = TrackingState::kInitialising;
  }

  /// The prior is strong where the robot does what it did; where that does not explain the scan, it is let go
  /// once and a wider kernel tried, from the prediction and from where the robot was last seen.
  Attempt align_or_retry(const PreparedScan& scan, const MotionPrior& prior) {
    Attempt best = odometer.align(scan, prior, Reach::kNear);
    if (explains(best, kJumpScore) || distrusted_scans > 0) return best;
    // A far look is dear, and a part of the points will do for it: the next scan must not wait.
    PreparedScan part = scan;
    part.source = every_nth(scan.source, std::max<std::size_t>(scan.source.size() / kFarPoints, 1));
    MotionPrior loose = prior;
    loose.information *= 0.01;
    Attempt far = odometer.align(part, loose, Reach::kFar);
    if (!explains(far, kJumpScore)) {
      loose.mean = {last_trusted_pose, Vector6::Zero()};
      far = better(std::move(far), odometer.align(part, loose, Reach::kFar));
    }
    loose.mean = far.alignment.moving;
    best = better(std::move(best), odometer.align(scan, loose, Reach::kNear));
    best.prior = prior;
    return best;
  }

  /// Whether the robot can have come there, as far as its motion is known: a place that explains the scan may
  /// be another that looks the same. Where much of the scan is left unexplained, by new ground or by another
  /// place, it has to be where it was predicted.
  static bool plausible(const Attempt& attempt) {
    const Matrix12 covariance = attempt.prior.information.inverse();
    const double metres = std::sqrt(covariance.diagonal().head<3>().maxCoeff());
    const double radians = std::sqrt(covariance.diagonal().segment<3>(3).maxCoeff());
    const Pose &found = attempt.alignment.moving.pose, &predicted = attempt.prior.mean.pose;
    if (usual_share(attempt.health))
      return near(found, predicted, 1.0 + 5.0 * metres, 10.0 * kDegree + 5.0 * radians);
    return near(found, predicted, 0.1 + 2.0 * metres, 2.0 * kDegree + 2.0 * radians);
  }

  /// A sensor that looks all around does not see new ground on all sides at once.
  static bool elsewhere(const PreparedScan& scan, const Health& health) {
    return health.score > kFitScore && health.share < kNewGroundShare * health.usual_share &&
           looks_around(scan.source);
  }

  static bool usual_share(const Health& health) { return health.share >= kUsualShare * health.usual_share; }

  bool trusted(const PreparedScan& scan, const Attempt& attempt) const {
    const bool wary = distrusted_scans > 0 && state != TrackingState::kInitialising;
    return explains(attempt, wary ? kCalmScore : kJumpScore) && plausible(attempt) &&
           !elsewhere(scan, attempt.health);
  }

  void track_on(std::int64_t utime, const PreparedScan& scan, double dt, const ScanPrior& hints,
                TrackedScan* tracked) {
    MotionPrior prior = odometer.predict(dt);
    Attempt attempt = odometer.deskew_first(scan, align_or_retry(scan, prior));
    if (hints.motion && !trusted(scan, attempt)) {  // what others say is asked where the scans do not suffice
      prior = predict(dt, hints);
      Attempt hinted = odometer.align(scan, prior, Reach::kNear);
      if (trusted(scan, hinted)) attempt = std::move(hinted);
    }
    finished(Stage::kAlign);
    if (trusted(scan, attempt)) {
      believe(utime, scan, attempt);
      state = TrackingState::kTracking;
      describe(attempt, PoseMethod::kIcp, tracked);
      return;
    }
    describe(attempt, PoseMethod::kPredicted, tracked);
    coast(utime, prior);
    if (state == TrackingState::kInitialising) {
      if (distrusted_scans >= kFalseStarts) start(utime, scan);
      return;
    }
    energy_before = attempt.health.energy;
    begin_or_follow(utime, dt, scan);
  }

  void believe(std::int64_t utime, const PreparedScan& scan, const Attempt& attempt) {
    odometer.accept(attempt);
    distrusted_scans = 0;
    last_trusted_pose = odometer.state().pose;
    last_trusted_utime = utime;
    excursion.reset();
    search.begin_anew();
    if (quiet_scans_left > 0) {
      --quiet_scans_left;
      return;
    }
    odometer.keep(utime, scan, attempt.health.share);
    if (archive.wants(last_trusted_pose.translation(), scan.median_range))
      archive.add(utime, last_trusted_pose, scan.median_range, deskewed(scan.source, odometer.state().twist));
  }

  /// Nothing was learnt: the prediction stands in, and is not believed for long.
  void coast(std::int64_t utime, const MotionPrior& prior) {
    MotionPrior coasting = prior;
    if (static_cast<double>(utime - last_trusted_utime) * kMicro > kCoastSeconds)
      coasting.mean.twist.setZero();
    odometer.coast(coasting);
    ++distrusted_scans;
    if (state == TrackingState::kInitialising || lost()) return;
    state = TrackingState::kDegraded;
    if (distrusted_scans > 1) lose();
  }

  // ---- lost

  void lose() {
    state = archive.empty() ? TrackingState::kLost : TrackingState::kRecovering;
    search.begin(odometer.state().pose.translation());
  }

  /// Where the excursion begins anew the gate widens by what may have happened unseen.
  void begin_or_follow(std::int64_t utime, double dt, const PreparedScan& scan) {
    if (excursion && excursion->follow(utime, dt, scan)) return;
    if (excursion && candidate) refuse("the scans that followed do not fit each other: ");
    search.begin_anew();
    earlier_finds.clear();
    const auto& covariance = odometer.covariance();
    gate_m = 0.5 + 3.0 * std::sqrt(covariance.diagonal().head<3>().maxCoeff());
    gate_rad = 3.0 * kDegree + 3.0 * std::sqrt(covariance.diagonal().segment<3>(3).maxCoeff());
    if (!excursion) excursion.emplace(config, utime, scan, odometer.state());
  }

  /// The state follows the excursion: where the robot would be, had it not been lost.
  /// It knows its way, so that the prediction does not get worse.
  void follow_excursion() {
    MotionPrior prior = odometer.predict(0);
    prior.mean = excursion->state();
    odometer.coast(prior);
  }

  void track_lost(std::int64_t utime, double dt, const PreparedScan& scan, TrackedScan* tracked) {
    if (!excursion) coast(utime, odometer.predict(dt));
    begin_or_follow(utime, dt, scan);
    ++distrusted_scans;
    Attempt attempt;
    const bool back = candidate ? confirm(scan, &attempt) : feel(scan, &attempt);
    finished(Stage::kAlign);
    if (back) {
      come_back(utime, scan, attempt, tracked);
      return;
    }
    follow_excursion();
    describe(attempt, PoseMethod::kPredicted, tracked);
    if (state == TrackingState::kRecovering && archive.empty()) state = TrackingState::kLost;
  }

  /// Tries where the robot must be if it was only blinded: at the prediction or where it was last seen, in
  /// turn. What it finds farther off is left to the certificate.
  bool feel(const PreparedScan& scan, Attempt* attempt) {
    const bool seldom = distrusted_scans > kPatience && distrusted_scans % kSeldom != 0;
    if (odometer.empty() || seldom) return false;
    const bool standing = distrusted_scans % 2 == 0;
    const MovingPose& predicted = excursion->state();
    MotionPrior prior;
    prior.mean = predicted;
    if (standing) prior.mean.pose = last_trusted_pose;
    prior.information = prior_information(gate_m, gate_rad, excursion->covariance());
    *attempt = odometer.align(scan, prior, gate_m < kFarGate ? Reach::kNear : Reach::kFar);
    const Pose& found = attempt->alignment.moving.pose;
    const double share = usual_share(attempt->health) ? 1.0 : 0.4;  // of the gate
    const bool there = standing ? near(found, last_trusted_pose, share * 0.5, share * 5.0 * kDegree)
                                : near(found, predicted.pose, share * gate_m, share * gate_rad);
    if (!there || !explains(*attempt, kCalmScore)) return false;
    candidate = Candidate{Contest({renormalised(found * predicted.pose.inverse())}, 1), std::nullopt};
    return false;
  }

  /// Whether one of the places is believed with this scan.
  bool confirm(const PreparedScan& scan, Attempt* attempt) {
    const Contest::Outcome outcome =
        candidate->contest.judge(odometer, scan, excursion->state(), excursion->covariance());
    *attempt = candidate->contest.attempt();
    if (outcome == Contest::Outcome::kRefuted) refuse("the scans that followed do not fit: ");
    if (outcome == Contest::Outcome::kUndecided) {
      if (candidate->answer) state = TrackingState::kAmbiguous;
      refuse("the scans that followed fit several places alike: ");
    }
    return outcome == Contest::Outcome::kWon;
  }

  void refuse(const std::string& why) {
    if (candidate->answer) {
      Recovery recovery = recovery_of(*candidate->answer);
      recovery.reason = why + candidate->answer->reason;
      recovery.energy_after = candidate->contest.attempt().health.energy;
      ended = recovery;
    }
    candidate.reset();
  }

  void come_back(std::int64_t utime, const PreparedScan& scan, const Attempt& attempt, TrackedScan* tracked) {
    PoseMethod method = PoseMethod::kIcp;
    if (candidate->answer) {
      method = PoseMethod::kGlobal;
      ++epoch;
      Recovery recovery = recovery_of(*candidate->answer);
      recovery.accepted = true;
      recovery.reason = candidate->answer->reason;
      recovery.map_from_predicted = candidate->contest.map_from_predicted();
      recovery.energy_after = attempt.health.energy;
      ended = recovery;
    }
    candidate.reset();
    quiet_scans_left = kQuietScans;
    believe(utime, scan, attempt);
    state = TrackingState::kTracking;
    describe(attempt, method, tracked);
  }

  Recovery recovery_of(const RecoveryAnswer& answer) const {
    Recovery recovery;
    recovery.search = answer;
    recovery.map_from_predicted = answer.map_from_predicted;
    recovery.energy_before = energy_before;
    return recovery;
  }

  void take(RecoveryAnswer answer) {
    if (!search.take(answer.serial) || !lost() || !excursion) return;
    if (answer.verdict == PlaceVerdict::kFound) {
      const Pose place = renormalised(answer.map_from_predicted * excursion->state().pose);
      if (!odometer_covers(place))
        odometer.reload(archive.keyframes(), place.translation(), scale.current(0));
      state = TrackingState::kRecovering;
      // Earlier finds are rivals too: what a few matches more or less decide is not decided.
      std::vector<Pose> places = {answer.map_from_predicted};
      for (const std::vector<Pose>& others : {answer.rivals, earlier_finds})
        places.insert(places.end(), others.begin(), others.end());
      places.resize(std::min(places.size(), kMostPlaces));
      earlier_finds.insert(earlier_finds.begin(), answer.map_from_predicted);
      candidate = Candidate{Contest(places), std::move(answer)};
      return;
    }
    if (state != TrackingState::kAmbiguous && search.looked_everywhere()) state = TrackingState::kLost;
    Recovery recovery = recovery_of(answer);
    recovery.reason = answer.reason;
    ended = recovery;
  }

  /// Whether the map at hand is one of that place.
  bool odometer_covers(const Pose& place) const {
    const auto& keyframes = odometer.map().keyframes();
    return std::any_of(keyframes.begin(), keyframes.end(), [&](const Keyframe& k) {
      return (k.map_from_body.translation() - place.translation()).norm() < 0.3 * search.scene();
    });
  }

  std::optional<Recovery> ended;  // since the last scan

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
    if (aligned)
      tracked->degenerate_axes = find_degeneracy(attempt.alignment.information.topLeftCorner<6, 6>()).axes;
  }

  void report(TrackedScan* tracked) {
    tracked->state = state;
    if (tracked->degenerate_axes != 0 && state == TrackingState::kTracking)
      tracked->state = TrackingState::kDegraded;
    tracked->epoch = epoch;
    tracked->map_from_body = odometer.state().pose;
    tracked->twist = odometer.state().twist;
    tracked->covariance = odometer.covariance().topLeftCorner<6, 6>();
    tracked->keyframes = static_cast<int>(odometer.map().keyframes().size());
    tracked->map_points = static_cast<int>(odometer.map().size());
    if (ended) {
      ended->epoch = epoch;
      ended->map_from_body = odometer.state().pose;
      tracked->recovery = std::exchange(ended, std::nullopt);
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
  double dt = state_->begun ? static_cast<double>(scan.utime - state_->last_utime) * kMicro : 0.0;
  if (state_->begun && dt <= 0 && dt >= -state_->config.restart_after_s) {
    tracked.verdict = dt == 0 ? ScanVerdict::kDuplicateTime : ScanVerdict::kBackwardTime;
    tracked.state = state_->state;
    return tracked;
  }
  if (dt < 0) {  // a log that loops: another drive begins
    reset();
    dt = 0;
  }
  State& s = *state_;

  const CroppedScan cropped = crop(scan.points, s.config.min_range_m, s.config.max_range_m);
  const PreparedScan prepared =
      thin_scan(scan.points, cropped, &s.scale, !s.begun, s.config.max_source_points);
  tracked.points_used = static_cast<int>(prepared.source.size());
  s.finished(Stage::kPreprocess);
  const bool seen = prepared.source.size() >= kLeastPoints;
  if (!seen) tracked.verdict = ScanVerdict::kEmpty;
  if (!seen && !s.begun) return tracked;

  if (!s.begun) {
    if (s.lost()) {
      s.begin_or_follow(scan.utime, 0, prepared);
    } else {
      s.start(scan.utime, prepared);
    }
    s.begun = true;
  } else if (!seen) {
    if (s.excursion) s.excursion->coast(dt);
    s.coast(scan.utime, s.predict(dt, hints));
    tracked.method = PoseMethod::kPredicted;
    tracked.stop_reason = StopReason::kTooFewPoints;
  } else if (s.lost()) {
    s.track_lost(scan.utime, dt, prepared, &tracked);
  } else {
    s.track_on(scan.utime, prepared, dt, hints, &tracked);
  }
  if (tracked.method == PoseMethod::kIcp) s.note_attitude(hints);
  s.last_utime = scan.utime;
  s.search.note_scene(prepared.median_range);
  s.report(&tracked);
  s.finished(Stage::kMap);
  return tracked;
}

std::optional<RecoveryRequest> Tracker::take_request() {
  State& s = *state_;
  if (!s.lost() || !s.excursion || s.candidate) return std::nullopt;
  return s.search.next(s.last_utime, *s.excursion, s.archive, s.up);
}

void Tracker::give(RecoveryAnswer answer) {
  state_->take(std::move(answer));
}

void Tracker::set_stage_observer(std::function<void(Stage)> observer) {
  state_->observer = std::move(observer);
}

void Tracker::reset() {
  auto fresh = std::make_unique<State>(state_->config);
  fresh->epoch = state_->epoch + 1;
  fresh->observer = state_->observer;
  state_ = std::move(fresh);
}

void Tracker::set_pose(const Pose& map_from_body) {
  State& s = *state_;
  ++s.epoch;
  s.candidate.reset();
  s.excursion.reset();
  s.search.begin_anew();
  s.odometer.set_pose(map_from_body);
  s.start_pose = s.last_trusted_pose = map_from_body;
  s.begun = false;
  if (s.archive.wants(map_from_body.translation(), 6.0 * s.search.scene())) {  // unknown ground: a new start
    s.state = TrackingState::kInitialising;
    return;
  }
  s.odometer.reload(s.archive.keyframes(), map_from_body.translation(), s.scale.current(0));
  s.lose();
  s.candidate = Candidate{Contest({Pose::Identity()}), std::nullopt};
}

SavedMap Tracker::save() const {
  return {state_->epoch, state_->last_trusted_pose, state_->archive.keyframes()};
}

void Tracker::load(SavedMap saved) {
  reset();
  State& s = *state_;
  s.epoch = std::max(s.epoch, saved.epoch + 1);
  s.archive.restore(std::move(saved.keyframes));
  if (s.archive.empty()) return;
  s.start_pose = s.last_trusted_pose = saved.last_pose;
  s.odometer.set_pose(saved.last_pose);
  s.lose();
}

PointCloud Tracker::map() const {
  return state_->odometer.map().snapshot();
}

}  // namespace scanlock
