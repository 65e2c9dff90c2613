// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "icp/scan_alignment.hpp"
#include "odometry/local_map.hpp"
#include "odometry/motion_filter.hpp"
#include "odometry/scan_preparation.hpp"

namespace scanlock {

namespace {

constexpr double kMicro = 1e-6;

/// A residual's variance as the filter sees it: neighbouring residuals share the error of their surface, so a scan of
/// thousands of points knows less than as many independent measurements.
constexpr double kVarianceInflation = 4;
constexpr double kLeastSigma = 0.015;  // metres: no LiDAR and no plane is better

}  // namespace

struct Tracker::State {
  TrackerConfig config;
  std::function<void(Stage)> observer;

  VoxelScale scale;
  LocalMap map;
  MotionFilter filter;
  ScanAligner aligner;
  std::int64_t last_utime = 0;
  double sigma = 0.03;       // metres, of a residual: robust, smoothed
  Pose last_keyframe_pose = Pose::Identity();
  Keyframe first;            // kept raw until its motion is known
  bool first_is_raw = false;
  std::uint32_t epoch = 0;

  explicit State(const TrackerConfig& c)
      : config(c),
        scale(c.map_points_per_scan, c.min_voxel_m, c.max_voxel_m),
        map({getenv("MK")?atoi(getenv("MK")):c.max_keyframes, c.max_map_points, c.max_range_m}),
        filter(c.acceleration, c.angular_acceleration) {}

  void finished(Stage stage) const {
    if (observer) observer(stage);
  }

  /// The prior with its pose relative to the origin of the map's floats.
  MotionPrior localised(MotionPrior prior) const {
    prior.mean.pose.translation() -= map.origin();
    return prior;
  }

  ScanAlignmentOptions alignment_options(double voxel) const {
    ScanAlignmentOptions options;
    options.nu_min = 2.1 * sigma;  // 95 % efficient on Gaussian residuals
    options.nu_max = (getenv("NU")?atof(getenv("NU")):2.0) * voxel;
    options.gate_margin = (getenv("GM")?atof(getenv("GM")):1.5) * voxel;
    options.sigma = sigma * std::sqrt(kVarianceInflation);
    options.threads = config.threads;
    return options;
  }

  ScanAlignment align(const PointCloud& source, const MotionPrior& prior, double voxel) {
    ScanAlignment alignment = aligner.align(source, map.target(), localised(prior), alignment_options(voxel));
    alignment.moving.pose.translation() += map.origin();
    return alignment;
  }

  void insert_keyframe(std::int64_t utime, const PointCloud& fine, const MovingPose& moving, double voxel) {
    Keyframe keyframe;
    keyframe.utime = utime;
    keyframe.map_from_body = moving.pose;
    keyframe.points = deskewed(fine, moving.twist);
    map.insert(std::move(keyframe), voxel);
    last_keyframe_pose = moving.pose;
  }
};

Tracker::Tracker(const TrackerConfig& config) : state_(std::make_unique<State>(config)) {}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

TrackedScan Tracker::track(const Scan& scan) {
  State& s = *state_;
  TrackedScan tracked;
  tracked.utime = scan.utime;
  tracked.points_in = static_cast<int>(scan.points.size());
  const CroppedScan cropped = crop(scan.points, s.config.min_range_m, s.config.max_range_m);
  const PreparedScan prepared = thin_scan(scan.points, cropped, &s.scale, s.map.empty(), s.config.max_source_points);
  const double voxel = prepared.voxel;
  s.finished(Stage::kPreprocess);
  tracked.points_used = static_cast<int>(prepared.source.size());

  if (s.map.empty()) {
    s.filter.start(Pose::Identity());
    s.first.points = prepared.fine;
    s.first.utime = scan.utime;
    s.first_is_raw = true;
    s.insert_keyframe(scan.utime, prepared.fine, s.filter.state(), voxel);
    s.last_utime = scan.utime;
    tracked.map_from_body = Pose::Identity();
    return tracked;
  }

  const double dt = static_cast<double>(scan.utime - s.last_utime) * kMicro;
  const MotionPrior prior = s.filter.predict(dt);
  ScanAlignment alignment = s.align(prepared.source, prior, voxel);
  if (s.first_is_raw && s.first.points.has_times()) {
    // The first scan could not be deskewed before its velocity was known: do it now, and align again.
    for (int round = 0; round < 2; ++round) {
      s.map.clear();
      s.insert_keyframe(s.first.utime, s.first.points, {Pose::Identity(), alignment.moving.twist}, voxel);
      alignment = s.align(prepared.source, prior, voxel);
    }
    s.first_is_raw = false;
    s.first.points = {};
  }
  s.finished(Stage::kAlign);

  const double sigma = std::max(1.4826 * alignment.median_residual, kLeastSigma);
  s.sigma += 0.1 * (std::min(sigma, 2.0 * s.sigma) - s.sigma);
  s.filter.update(prior, alignment, s.sigma * s.sigma * kVarianceInflation);
  s.last_utime = scan.utime;

  const Pose moved = s.last_keyframe_pose.inverse() * s.filter.state().pose;
  if (moved.translation().norm() > (getenv("KF")?atof(getenv("KF")):2.0) * voxel || so3_log(moved.linear()).norm() > 0.1) {
    s.insert_keyframe(scan.utime, prepared.fine, s.filter.state(), voxel);
  }
  s.finished(Stage::kMap);

  tracked.state = TrackingState::kTracking;
  tracked.method = PoseMethod::kIcp;
  tracked.stop_reason = alignment.converged ? StopReason::kConverged : StopReason::kIterations;
  tracked.map_from_body = s.filter.state().pose;
  tracked.twist = s.filter.state().twist;
  tracked.covariance = s.filter.covariance().topLeftCorner<6, 6>();
  tracked.iterations = alignment.iterations;
  tracked.inliers = alignment.matched;
  tracked.energy = alignment.median_residual; tracked.energy_baseline = alignment.evaluations;
  tracked.keyframes = static_cast<int>(s.map.keyframes().size());
  tracked.map_points = static_cast<int>(s.map.size());
  tracked.energy_score = static_cast<double>(alignment.searches_made) / static_cast<double>(alignment.searches_made + alignment.searches_saved);
  return tracked;
}

void Tracker::set_stage_observer(std::function<void(Stage)> observer) { state_->observer = std::move(observer); }

void Tracker::reset() {
  State& s = *state_;
  const std::uint32_t epoch = s.epoch;
  const std::function<void(Stage)> observer = s.observer;
  state_ = std::make_unique<State>(s.config);
  state_->epoch = epoch + 1;
  state_->observer = observer;
}

PointCloud Tracker::map() const { return state_->map.snapshot(); }

const char* to_string(TrackingState state) {
  switch (state) {
    case TrackingState::kInitialising: return "INITIALISING";
    case TrackingState::kTracking: return "TRACKING";
    case TrackingState::kDegraded: return "DEGRADED";
    case TrackingState::kRecovering: return "RECOVERING";
    case TrackingState::kAmbiguous: return "AMBIGUOUS";
    case TrackingState::kLost: return "LOST";
  }
  return "?";
}

const char* to_string(PoseMethod method) {
  switch (method) {
    case PoseMethod::kNone: return "none";
    case PoseMethod::kIcp: return "icp";
    case PoseMethod::kGlobal: return "global";
    case PoseMethod::kPredicted: return "predicted";
  }
  return "?";
}

const char* to_string(StopReason reason) {
  switch (reason) {
    case StopReason::kNone: return "none";
    case StopReason::kConverged: return "converged";
    case StopReason::kIterations: return "iteration limit";
    case StopReason::kTooFewPoints: return "too few points";
    case StopReason::kDiverged: return "diverged";
  }
  return "?";
}

const char* to_string(ScanVerdict verdict) {
  switch (verdict) {
    case ScanVerdict::kTracked: return "tracked";
    case ScanVerdict::kEmpty: return "empty";
    case ScanVerdict::kDuplicateTime: return "duplicate utime";
    case ScanVerdict::kBackwardTime: return "backward utime";
  }
  return "?";
}

}  // namespace scanlock
