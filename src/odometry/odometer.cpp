// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/odometer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/voxel_grid.hpp"
#include "global/cloud_normals.hpp"
#include "icp/degeneracy.hpp"

namespace scanlock {
namespace {

/// Factor on the variance of a residual as the filter sees it: neighbouring residuals share the error of
/// their surface, so a scan of thousands of points carries less information than as many independent
/// measurements.
constexpr double kVarianceInflation = 6;
/// Kernels and gates scale with this share of the median range, or with the voxel if that is larger: the
/// error of a prediction depends on the scene and the motion, not on the density of the sensor.
constexpr double kReach = 0.04;
/// Points nearer each other than this share of the median range share the errors of their surfaces.
constexpr double kPatch = 0.5;
constexpr double kLeastSigma = 0.015;  // metres: no LiDAR and no fitted plane is more precise
constexpr double kFirstSigma = 0.03;
constexpr double kNearFirst = 3,
                 kFarFirst = 6;  // times the reach: a wider first kernel is drawn to where most points are
/// A cap on cost. An alignment that ends before it has converged stays near its prediction, so that errors of
/// the velocity are passed on to the next alignment.
constexpr int kMostIterations = 36;

/// Radians, added to the predicted heading: a robot with a planar sensor may turn on the spot, between two
/// scans by more than ICP can follow.
constexpr double kTurns[] = {-0.2, 0.2, -0.4, 0.4, -0.6, 0.6, -0.8, 0.8};

constexpr double kLeastShare = 0.3;
constexpr double kMostEnergy = 0.55;  // whatever the history of energies is
constexpr double kMostAtFirst = 0.7;  // the same for a map of few scans, which is thin
constexpr double kLeastOfUsualShare = 0.8;

/// Standard deviation, metres, of the predicted position of a scan's points at this range.
double displacement(const MotionPrior& prior, double range) {
  const Matrix6 predicted = pose_covariance(prior);
  return std::sqrt((predicted.topLeftCorner<3, 3>().trace() +
                    range * range * predicted.bottomRightCorner<3, 3>().trace()) /
                   3);
}

Observed observed(const Attempt& attempt, double variance) {
  return scanlock::observed(attempt.alignment.pose_information / variance, attempt.alignment.noise / variance,
                            pose_covariance(attempt.prior));
}

/// The alignment with the part of its motion that rests on errors of normals replaced by the prediction.
ScanAlignment corrected(const Attempt& attempt, const Observed& seen) {
  const ScanAlignment& alignment = attempt.alignment;
  ScanAlignment result = alignment;
  const MovingPose predicted = attempt.told.value_or(attempt.prior.mean);
  result.moving.pose =
      predicted.pose * se3_exp(seen.motion * se3_log(predicted.pose.inverse() * alignment.moving.pose));
  result.moving.twist = predicted.twist + seen.motion * (alignment.moving.twist - predicted.twist);
  result.moving.acceleration = seen.motion * alignment.moving.acceleration;
  Matrix12 both = Matrix12::Zero();
  both.topLeftCorner<6, 6>() = both.bottomRightCorner<6, 6>() = seen.information;
  result.information = both.transpose() * alignment.information * both;
  return result;
}

}  // namespace

Matrix6 Attempt::information() const {
  return corrected(*this, observed(*this, variance)).information.topLeftCorner<6, 6>() / variance;
}

Odometer::Odometer(const TrackerConfig& config)
    : config_(config),
      map_({config.max_keyframes, config.max_map_points, config.max_range_m}),
      filter_(config.acceleration, config.angular_acceleration),
      sigma_(kFirstSigma) {}

void Odometer::start(std::int64_t utime, const PreparedScan& scan, const MovingPose& guess) {
  map_.clear();
  health_.forget();
  sigma_ = kFirstSigma;
  set_planar(scan.planar);
  filter_.start(guess);
  Matrix12 of_velocity = Matrix12::Zero();  // the frame is that of the pose
  of_velocity.bottomRightCorner<6, 6>() = filter_.covariance().bottomRightCorner<6, 6>();
  errors_.start(of_velocity);
  drift_.setZero();
  new_drift_.setZero();
  untold_ = 1;
  first_.utime = utime;
  first_.points = scan.fine.has_times() ? scan.fine : PointCloud{};
  insert(utime, scan, filter_.state());
}

void Odometer::set_planar(bool planar) {
  map_.set_planar(planar);
  filter_.set_planar(planar);
  errors_.start(filter_.covariance());
}

namespace {

/// At most `most` of the first `count` archived keyframes, those nearest to `centre`, in order of decreasing
/// distance.
std::vector<const ArchivedKeyframe*> nearest_keyframes(const std::vector<ArchivedKeyframe>& archived,
                                                       std::size_t count, const Eigen::Vector3d& centre,
                                                       int most) {
  std::vector<std::pair<double, const ArchivedKeyframe*>> nearest;
  for (std::size_t i = 0; i < count; ++i)
    nearest.emplace_back((archived[i].map_from_body.translation() - centre).norm(), &archived[i]);
  const std::size_t taken = std::min(count, static_cast<std::size_t>(most));
  std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(taken), nearest.end());
  std::vector<const ArchivedKeyframe*> keyframes;
  for (std::size_t i = taken; i-- > 0;) keyframes.push_back(nearest[i].second);
  return keyframes;
}

/// The keyframe without its points.
Keyframe keyframe_of(const ArchivedKeyframe& archived, bool given) {
  Keyframe keyframe;
  keyframe.utime = archived.utime;
  keyframe.map_from_body = archived.map_from_body;
  if (given) keyframe.given = archived.id;
  return keyframe;
}

}  // namespace

void Odometer::reload(const std::vector<ArchivedKeyframe>& archived, const Eigen::Vector3d& centre,
                      double voxel, std::size_t given) {
  // The map drops keyframes from the front, where the farthest ones are.
  std::vector<Keyframe> keyframes;
  for (const ArchivedKeyframe* k :
       nearest_keyframes(archived, archived.size(), centre, config_.max_keyframes)) {
    keyframes.push_back(keyframe_of(*k, static_cast<std::size_t>(k - archived.data()) < given));
    keyframes.back().points = *k->points.cloud();
  }
  first_.points = {};
  if (!keyframes.empty()) last_keyframe_pose_ = keyframes.back().map_from_body;
  map_.load(std::move(keyframes), voxel);
}

double Odometer::found_on(const std::vector<ArchivedKeyframe>& archived, std::size_t given, double voxel) {
  const Eigen::Vector3d here = state().pose.translation();
  std::vector<Keyframe> keyframes;
  double farthest = 0;
  for (const ArchivedKeyframe* k : nearest_keyframes(archived, given, here, config_.max_keyframes)) {
    const double distance = (k->map_from_body.translation() - here).norm();
    if (distance > config_.max_range_m) continue;
    farthest = std::max(farthest, distance);
    keyframes.push_back(keyframe_of(*k, true));
    if (!map_.has(k->id, k->map_from_body)) keyframes.back().points = *k->points.cloud();
  }
  map_.found_on(std::move(keyframes), voxel);
  return farthest;
}

void Odometer::take_usual_from(const Odometer& other) {
  if (health_.has_history()) return;
  set_usual(other.usual());
}

void Odometer::set_usual(const Usual& usual) {
  health_ = usual.health;
  sigma_ = usual.sigma;
  share_ = usual.share;
}

ScanAlignmentOptions Odometer::options(const PreparedScan& scan, const MotionPrior& prior, Reach reach,
                                       Sides sides) const {
  const bool far = reach == Reach::kFar;
  const double reach_m = std::max(scan.voxel, kReach * scan.median_range);
  ScanAlignmentOptions result;
  result.nu_min = kKernel * sigma_;
  result.nu_first =
      std::min(displacement(prior, scan.median_range), (far ? kFarFirst : kNearFirst) * reach_m);
  result.nu_max = (far ? 20.0 : 8.0) * reach_m;
  result.max_iterations = kMostIterations;
  result.gate_margin = (far ? 3.0 : 1.5) * reach_m;
  result.sigma = sigma_ * std::sqrt(inflation());
  result.patch = patch(scan);
  result.sided = sides == Sides::kSeen;
  result.threads = config_.threads;
  return result;
}

Attempt Odometer::align(const PreparedScan& scan, const MotionPrior& prior, Reach reach, Sides sides) {
  Attempt attempt;
  attempt.prior = prior;
  MotionPrior local = prior;  // coordinates of the map are relative to its origin
  local.mean.pose.translation() -= map_.origin();
  attempt.alignment = aligner_.align(scan.source, map_.target(), local, options(scan, prior, reach, sides));
  attempt.alignment.moving.pose.translation() += map_.origin();
  attempt.variance = variance();
  attempt.health = health_.assess(aligner_.residuals(), aligner_.distances(), aligner_.weights(),
                                  kKernel * sigma_, map_.planar() ? planar_chance(scan.whole) : 0.0);
  return attempt;
}

std::vector<PointMatch> Odometer::point_matches() {
  std::vector<PointMatch> matches;
  const std::vector<PointFit> fits = aligner_.fits(map_.target());
  for (std::size_t i = 0; i < fits.size(); ++i) {
    PointMatch& match = matches.emplace_back();
    match.known = aligner_.weights()[i] > 0;
    if (!match.known) continue;
    match.explained = is_inlier(aligner_.residuals()[i], kKernel * sigma_);
    const Surface& surface = fits[i].surface;
    match.steep = surface.line || std::abs(surface.normal.z()) < kLevel;
  }
  return matches;
}

double Odometer::patch(const PreparedScan& scan) {
  return kPatch * scan.median_range;
}

Attempt Odometer::look_far(const PreparedScan& scan, const MotionPrior& prior, Sides sides) {
  Attempt best = align(scan, prior, Reach::kFar, sides);
  const bool turned_unseen = prior.ahead_s > kMoment && !has_usual_inlier_ratio(best.health);
  if (!turned_unseen && (!map_.planar() || best.health.score <= kFitScore)) return best;
  for (const double turn : kTurns) {
    MotionPrior turned = prior;
    turned.mean.pose.linear() = prior.mean.pose.linear() * rotation_about_z(turn);
    if (prior.ahead_s > 0) turned.mean.twist = twist_to(turned.mean.pose, prior.ahead_s);
    best = better(std::move(best), align(scan, turned, Reach::kFar, sides));
  }
  best.prior = prior;
  return best;
}

Vector6 Odometer::twist_to(const Pose& pose, double seconds) const {
  return se3_log(filter_.state().pose.inverse() * pose) / seconds;
}

Attempt Odometer::probe(const PreparedScan& scan, const MotionPrior& prior, Reach reach, Sides sides) {
  const PreparedScan few = part_of(scan, kLookPoints);
  Attempt part = reach == Reach::kFar ? look_far(few, prior, sides) : align(few, prior, reach, sides);
  if (!explains(part, kJumpScore)) return part;
  if (reach == Reach::kNear) return align(scan, prior, reach, sides);
  MotionPrior arrived = prior;  // the far search was made with the part already
  arrived.mean = part.alignment.moving;
  Attempt whole = align(scan, arrived, Reach::kNear, sides);
  whole.prior = prior;
  return whole;
}

double Odometer::inflation() const {
  return kVarianceInflation / (share_ * share_ * share_);
}

double Odometer::variance() const {
  return sigma_ * sigma_ * inflation();
}

void Odometer::accept(const Attempt& attempt) {
  share_ += 0.3 * (std::max(attempt.health.inlier_ratio, kLeastShare) - share_);
  const double seen = std::max(1.4826 * attempt.alignment.median_residual, kLeastSigma);
  sigma_ += 1.0 / HealthMonitor::kHistory * (std::min(seen, 2.0 * sigma_) - sigma_);
  const Pose before = filter_.state().pose;
  const Observed seen_part = observed(attempt, variance());
  const ScanAlignment real = corrected(attempt, seen_part);
  errors_.update(attempt.prior, attempt.alignment, seen_part.motion, variance(), real.moving);
  MotionPrior prior = attempt.prior;
  prior.mean = attempt.told.value_or(prior.mean);
  filter_.update(prior, real, variance());
  follow_drift(before);
  // The frame is that of the first stamp; the points of the first scan are placed by the velocity of now.
  const double ahead = real.moving.middle_s;
  add_drift(untold_ * ahead * ahead * errors_.covariance().bottomRightCorner<6, 6>());
  untold_ = 0;
  health_.remember(attempt.health);
}

void Odometer::coast(const MotionPrior& prior) {
  const Pose before = filter_.state().pose;
  filter_.coast(prior);
  errors_.coast(prior);
  follow_drift(before);
}

void Odometer::set_pose(const Pose& map_from_body) {
  filter_.start({map_from_body, Vector6::Zero()});
  errors_.start(filter_.covariance());
  drift_.setZero();
  new_drift_.setZero();
}

/// Limits the acceleration within a scan to what occurred lately.
MotionPrior Odometer::as_lately(MotionPrior prior) const {
  prior.acceleration_density.array() *= errors_.shares().cwiseMin(1.0).array();
  return prior;
}

void Odometer::follow_drift(const Pose& before) {
  const Matrix6 moved = adjoint(filter_.state().pose.inverse() * before);
  for (Matrix6* drift : {&drift_, &new_drift_}) *drift = moved * *drift * moved.transpose();
}

void Odometer::add_drift(const Matrix6& more) {
  drift_ += more;
  new_drift_ += more;
}

void Odometer::keep(std::int64_t utime, const PreparedScan& scan, double overlap) {
  if (wants_keyframe(overlap, scan.voxel)) insert(utime, scan, filter_.state());
}

bool Odometer::wants_keyframe(double overlap, double voxel) const {
  const Pose moved = last_keyframe_pose_.inverse() * filter_.state().pose;
  const double distance = moved.translation().norm(), angle = so3_log(moved.linear()).norm();
  const bool new_ground = overlap < 0.8 && (distance > voxel || angle > 0.05);
  return distance > 3.0 * voxel || angle > 0.15 || new_ground;
}

void Odometer::insert(std::int64_t utime, const PreparedScan& scan, const MovingPose& moving) {
  Keyframe keyframe;
  keyframe.utime = utime;
  keyframe.map_from_body = moving.pose;
  keyframe.points = deskewed(scan.fine, moving);
  // New ground is placed with the error of the pose from which it was seen: from now on that share of the
  // pose's variance belongs to the map.
  const double share = map_.insert(std::move(keyframe), scan.voxel);
  add_drift(share * pose_covariance());
  errors_.leave_to_map(share);
  last_keyframe_pose_ = moving.pose;
}

bool explains(const Attempt& attempt, double most_score) {
  const Health& h = attempt.health;
  return attempt.alignment.moving.pose.matrix().allFinite() && h.score < most_score &&
         h.energy < (h.short_history ? kMostAtFirst : kMostEnergy) &&
         h.inliers >= static_cast<int>(kLeastPoints);
}

double inlier_ratio_to_usual(const Health& health) {
  return health.median_inlier_ratio > 0 ? health.inlier_ratio / health.median_inlier_ratio : 1;
}

bool has_usual_inlier_ratio(const Health& health) {
  return inlier_ratio_to_usual(health) >= kLeastOfUsualShare;
}

PreparedScan part_of(const PreparedScan& scan, std::size_t points) {
  PreparedScan part;
  part.voxel = scan.voxel;
  part.median_range = scan.median_range;
  part.whole = scan.whole;
  std::vector<std::uint32_t> indices;
  const std::size_t step = std::max<std::size_t>(scan.source.size() / points, 1);
  for (std::size_t i = 0; i < scan.source.size(); i += step) indices.push_back(static_cast<std::uint32_t>(i));
  part.source = select(scan.source, indices);
  return part;
}

Attempt better(Attempt a, Attempt b) {
  return b.cost() < a.cost() ? std::move(b) : std::move(a);
}

}  // namespace scanlock
