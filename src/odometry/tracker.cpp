// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "icp/degeneracy.hpp"
#include "icp/scan_alignment.hpp"
#include "odometry/health.hpp"
#include "odometry/local_map.hpp"
#include "odometry/motion_filter.hpp"
#include "odometry/scan_preparation.hpp"

namespace scanlock {
namespace {

constexpr double kMicro = 1e-6;
constexpr std::size_t kLeastPoints = 30;  // fewer cannot fix six numbers against outliers

/// A residual's variance as the filter sees it: neighbouring residuals share the error of their surface, so a
/// scan of thousands of points knows less than as many independent measurements.
constexpr double kVarianceInflation = 10;
/// Kernels and gates are this share of the median range, where the voxel is smaller: how far a prediction is
/// off depends on the scene and the motion, not on the density of the sensor.
constexpr double kReach = 0.04;
constexpr double kLeastSigma = 0.015;  // metres: no LiDAR and no plane is better
constexpr double kFirstSigma = 0.03;
constexpr double kKernel = 2.1;  // Welsch scale over sigma: 95 % efficient on Gaussian residuals

// Trust in an alignment. The score of good ones stays below 5 in streets and rooms; a kidnap gives 10 and
// more.
constexpr double kJumpScore = 6.0;
constexpr double kCalmScore = 4.0;  // hysteresis: what a lost tracker must get below
constexpr double kLeastOverlap = 0.25;
constexpr double kMostEnergy = 0.55;  // whatever the history says
constexpr int kCalmScans = 2;         // in a row, before a lost tracker is believed again
constexpr int kQuietScans = 5;        // after that, before the map may grow
constexpr double kCoastSeconds =
    3.0;  // a lost robot is predicted at its last velocity for so long, then as standing

struct Attempt {
  ScanAlignment alignment;
  MotionPrior prior;
  Health health;
  /// Unexplained share of the scan.
  double cost() const { return 1.0 - health.overlap * (1.0 - health.energy); }
};

}  // namespace

struct Tracker::State {
  TrackerConfig config;
  std::function<void(Stage)> observer;

  VoxelScale scale;
  LocalMap map;
  MotionFilter filter;
  ScanAligner aligner;
  HealthMonitor health;

  std::int64_t last_utime = 0;
  double sigma = kFirstSigma;  // metres, of a residual: robust, smoothed
  Pose last_keyframe_pose = Pose::Identity();
  KeyframeArchive archive{2000000};
  Pose origin = Pose::Identity();  // where the first scan stands
  Keyframe first;                  // its points as they came, until their motion is known
  std::uint32_t epoch = 0;

  TrackingState state = TrackingState::kInitialising;
  Pose last_trusted_pose = Pose::Identity();
  std::int64_t last_trusted_utime = 0;
  int distrusted_scans = 0;  // in a row
  int calm_scans = 0;        // in a row, while lost
  int quiet_scans_left = 0;

  explicit State(const TrackerConfig& c)
      : config(c),
        scale(c.map_points_per_scan, c.min_voxel_m, c.max_voxel_m),
        map({c.max_keyframes, c.max_map_points, c.max_range_m}),
        filter(c.acceleration, c.angular_acceleration) {}

  void finished(Stage stage) const {
    if (observer) observer(stage);
  }

  bool lost() const { return state == TrackingState::kLost; }

  // ---- alignment
  // ----------------------------------------------------------------------------------------------

  ScanAlignmentOptions options(double reach, bool wide) const {
    ScanAlignmentOptions result;
    result.nu_min = kKernel * sigma;
    result.nu_max = (wide ? 20.0 : 8.0) * reach;
    result.gate_margin = (wide ? 3.0 : 1.5) * reach;
    result.sigma = sigma * std::sqrt(kVarianceInflation);
    result.threads = config.threads;
    return result;
  }

  Attempt align(const PreparedScan& scan, const MotionPrior& prior, bool wide) {
    Attempt attempt;
    attempt.prior = prior;
    MotionPrior local = prior;  // coordinates of the map are relative to its origin
    local.mean.pose.translation() -= map.origin();
    attempt.alignment = aligner.align(scan.source, map.target(), local,
                                      options(std::max(scan.voxel, kReach * scan.median_range), wide));
    attempt.alignment.moving.pose.translation() += map.origin();
    attempt.health = health.assess(aligner.residuals(), aligner.weights(), kKernel * sigma);
    return attempt;
  }

  static Attempt better(Attempt a, Attempt b) { return b.cost() < a.cost() ? std::move(b) : std::move(a); }

  bool trusted(const Attempt& attempt) const {
    const Health& h = attempt.health;
    return attempt.alignment.moving.pose.matrix().allFinite() &&
           h.score < (lost() ? kCalmScore : kJumpScore) && h.energy < kMostEnergy &&
           h.overlap > kLeastOverlap && h.inliers >= static_cast<int>(kLeastPoints);
  }

  /// The prior is strong where the robot does what it did; where that does not explain the scan, it is let go
  /// and a wider kernel tried, from the prediction and from where the robot was last seen.
  Attempt align_or_retry(const PreparedScan& scan, const MotionPrior& prior) {
    Attempt best = align(scan, prior, false);
    if (trusted(best)) return best;
    MotionPrior loose = prior;
    loose.information *= 0.01;
    MotionPrior standing = loose;
    standing.mean = {last_trusted_pose, Vector6::Zero()};
    // A lost tracker tries on every scan: one start each, in turn, keeps it within the time of a scan.
    const bool try_loose = !lost() || distrusted_scans % 2 == 1, try_standing = !lost() || !try_loose;
    if (try_loose) best = better(std::move(best), align(scan, loose, true));
    if (try_standing && !trusted(best)) best = better(std::move(best), align(scan, standing, true));
    return best;
  }

  // ---- map
  // ----------------------------------------------------------------------------------------------------

  void insert_keyframe(std::int64_t utime, const PreparedScan& scan, const MovingPose& moving) {
    Keyframe keyframe;
    keyframe.utime = utime;
    keyframe.map_from_body = moving.pose;
    keyframe.points = deskewed(scan.fine, moving.twist);
    if (archive.wants(moving.pose.translation(), scan.median_range))
      archive.add(utime, moving.pose, scan.median_range, keyframe.points);
    map.insert(std::move(keyframe), scan.voxel);
    last_keyframe_pose = moving.pose;
  }

  bool wants_keyframe(double overlap, double voxel) const {
    const Pose moved = last_keyframe_pose.inverse() * filter.state().pose;
    const double distance = moved.translation().norm(), angle = so3_log(moved.linear()).norm();
    const bool new_ground = overlap < 0.8 && (distance > voxel || angle > 0.05);
    return distance > 3.0 * voxel || angle > 0.15 || new_ground;
  }

  // ---- the ways a scan can go
  // -----------------------------------------------------------------------------------

  void start(const Scan& scan, const PreparedScan& prepared) {
    filter.start(origin);
    first.utime = scan.utime;
    first.points = prepared.fine;
    insert_keyframe(scan.utime, prepared, filter.state());
    last_trusted_utime = scan.utime;
  }

  /// The first scan could not be deskewed before its velocity was known: does it now, and aligns the second
  /// one again.
  Attempt deskew_first(const PreparedScan& prepared, Attempt attempt) {
    PreparedScan again;
    again.fine = std::move(first.points);
    again.voxel = prepared.voxel;
    first.points = {};
    if (!again.fine.has_times()) return attempt;
    for (int round = 0; round < 2; ++round) {
      map.clear();
      insert_keyframe(first.utime, again, {origin, attempt.alignment.moving.twist});
      attempt = align(prepared, attempt.prior, false);
    }
    return attempt;
  }

  void accept(const Scan& scan, const Attempt& attempt) {
    const double seen = std::max(1.4826 * attempt.alignment.median_residual, kLeastSigma);
    sigma += 0.1 * (std::min(seen, 2.0 * sigma) - sigma);
    filter.update(attempt.prior, attempt.alignment, sigma * sigma * kVarianceInflation);
    distrusted_scans = 0;
    if (lost() && ++calm_scans < kCalmScans) return;  // a second scan has to agree first
    if (lost()) quiet_scans_left = kQuietScans;
    calm_scans = 0;
    health.remember(attempt.health.energy);
    last_trusted_pose = filter.state().pose;
    last_trusted_utime = scan.utime;
    state = TrackingState::kTracking;
  }

  /// Nothing was learnt: the prediction stands in, and is not believed for long.
  void coast(const Scan& scan, const MotionPrior& prior) {
    MotionPrior coasting = prior;
    if (static_cast<double>(scan.utime - last_trusted_utime) * kMicro > kCoastSeconds)
      coasting.mean.twist.setZero();
    filter.coast(coasting);
    calm_scans = 0;
    ++distrusted_scans;
    if (state != TrackingState::kInitialising) {
      state = distrusted_scans > 1 || lost() ? TrackingState::kLost : TrackingState::kDegraded;
    }
  }

  void report(TrackedScan* tracked) const {
    tracked->state = state;
    tracked->epoch = epoch;
    tracked->map_from_body = filter.state().pose;
    tracked->twist = filter.state().twist;
    tracked->covariance = filter.covariance().topLeftCorner<6, 6>();
    tracked->keyframes = static_cast<int>(map.keyframes().size());
    tracked->map_points = static_cast<int>(map.size());
  }
};

Tracker::Tracker(const TrackerConfig& config) : state_(std::make_unique<State>(config)) {}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

TrackedScan Tracker::track(const Scan& scan, const ScanPrior& /*hints*/) {
  TrackedScan tracked;
  tracked.utime = scan.utime;
  tracked.points_in = static_cast<int>(scan.points.size());
  const bool begun = !state_->map.empty();
  const double dt = begun ? static_cast<double>(scan.utime - state_->last_utime) * kMicro : 0.0;
  if (begun && dt <= 0 && dt >= -state_->config.restart_after_s) {
    tracked.verdict = dt == 0 ? ScanVerdict::kDuplicateTime : ScanVerdict::kBackwardTime;
    tracked.state = state_->state;
    return tracked;
  }
  if (dt < 0) reset();  // a log that loops: another drive begins
  State& s = *state_;

  const CroppedScan cropped = crop(scan.points, s.config.min_range_m, s.config.max_range_m);
  const PreparedScan prepared =
      thin_scan(scan.points, cropped, &s.scale, s.map.empty(), s.config.max_source_points);
  tracked.points_used = static_cast<int>(prepared.source.size());
  s.finished(Stage::kPreprocess);
  const bool seen = prepared.source.size() >= kLeastPoints;
  if (!seen) tracked.verdict = ScanVerdict::kEmpty;

  if (s.map.empty()) {
    if (!seen) return tracked;
    s.start(scan, prepared);
    s.last_utime = scan.utime;
    s.finished(Stage::kMap);
    s.report(&tracked);
    return tracked;
  }

  const MotionPrior prior = s.filter.predict(dt);
  s.last_utime = scan.utime;
  if (!seen) {
    s.coast(scan, prior);
    tracked.method = PoseMethod::kPredicted;
    tracked.stop_reason = StopReason::kTooFewPoints;
    s.report(&tracked);
    return tracked;
  }

  Attempt attempt = s.align_or_retry(prepared, prior);
  if (!s.first.points.empty()) attempt = s.deskew_first(prepared, std::move(attempt));
  s.finished(Stage::kAlign);
  const bool trusted = s.trusted(attempt);
  if (trusted) {
    s.accept(scan, attempt);
  } else {
    s.coast(scan, prior);
  }
  s.report(&tracked);
  tracked.method = trusted ? PoseMethod::kIcp : PoseMethod::kPredicted;
  tracked.stop_reason = !trusted                      ? StopReason::kDiverged
                        : attempt.alignment.converged ? StopReason::kConverged
                                                      : StopReason::kIterations;
  tracked.iterations = attempt.alignment.iterations;
  tracked.inliers = attempt.health.inliers;
  tracked.energy = attempt.health.energy;
  tracked.energy_baseline = attempt.health.baseline;
  tracked.energy_score = attempt.health.score;
  tracked.degenerate_axes = find_degeneracy(attempt.alignment.information.topLeftCorner<6, 6>()).axes;
  if (tracked.degenerate_axes != 0 && tracked.state == TrackingState::kTracking)
    tracked.state = TrackingState::kDegraded;

  if (s.state == TrackingState::kTracking) {
    if (s.quiet_scans_left > 0) {
      --s.quiet_scans_left;
    } else if (s.wants_keyframe(attempt.health.overlap, prepared.voxel)) {
      s.insert_keyframe(scan.utime, prepared, s.filter.state());
    }
  }
  s.finished(Stage::kMap);
  return tracked;
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
  reset();
  state_->origin = map_from_body;
}

SavedMap Tracker::save() const {
  return {state_->epoch, state_->last_trusted_pose, state_->archive.keyframes()};
}

void Tracker::load(SavedMap saved) {
  reset();
  state_->epoch = saved.epoch + 1;
  state_->archive.restore(std::move(saved.keyframes));
}

PointCloud Tracker::map() const {
  return state_->map.snapshot();
}

const char* to_string(TrackingState state) {
  switch (state) {
    case TrackingState::kInitialising:
      return "INITIALISING";
    case TrackingState::kTracking:
      return "TRACKING";
    case TrackingState::kDegraded:
      return "DEGRADED";
    case TrackingState::kRecovering:
      return "RECOVERING";
    case TrackingState::kAmbiguous:
      return "AMBIGUOUS";
    case TrackingState::kLost:
      return "LOST";
  }
  return "?";
}

const char* to_string(PoseMethod method) {
  switch (method) {
    case PoseMethod::kNone:
      return "none";
    case PoseMethod::kIcp:
      return "icp";
    case PoseMethod::kGlobal:
      return "global";
    case PoseMethod::kPredicted:
      return "predicted";
  }
  return "?";
}

const char* to_string(StopReason reason) {
  switch (reason) {
    case StopReason::kNone:
      return "none";
    case StopReason::kConverged:
      return "converged";
    case StopReason::kIterations:
      return "iteration limit";
    case StopReason::kTooFewPoints:
      return "too few points";
    case StopReason::kDiverged:
      return "diverged";
  }
  return "?";
}

const char* to_string(ScanVerdict verdict) {
  switch (verdict) {
    case ScanVerdict::kTracked:
      return "tracked";
    case ScanVerdict::kEmpty:
      return "empty";
    case ScanVerdict::kDuplicateTime:
      return "duplicate utime";
    case ScanVerdict::kBackwardTime:
      return "backward utime";
  }
  return "?";
}

}  // namespace scanlock
