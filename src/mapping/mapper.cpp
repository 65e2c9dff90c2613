// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/mapper.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"

namespace scanlock {
namespace {

constexpr std::uint32_t kOrigin = 0;     // node of the map's frame; keyframes have greater numbers
constexpr double kFloor = 1e-3;          // metres and radians: no pose is known better
constexpr std::size_t kMostAround = 20;  // keyframes that make one side of a closure: a cap on its cost
constexpr double kWorthwhile = 2.0;      // times the variance of the last closure
constexpr double kJumpMetres = 0.05, kJumpRadians = 0.5 * kDegree;  // more is told as a new epoch

std::vector<ArchivedKeyframe> nearest_to(const Eigen::Vector3d& position,
                                         std::vector<ArchivedKeyframe> some) {
  std::stable_sort(some.begin(), some.end(), [&](const ArchivedKeyframe& a, const ArchivedKeyframe& b) {
    return (a.map_from_body.translation() - position).squaredNorm() <
           (b.map_from_body.translation() - position).squaredNorm();
  });
  some.resize(std::min(some.size(), kMostAround));
  return some;
}

double size_of(const Matrix6& covariance, double arm) {
  return covariance.topLeftCorner<3, 3>().trace() + arm * arm * covariance.bottomRightCorner<3, 3>().trace();
}

}  // namespace

MapAnswer MapWorker::work(const MapRequest& request) {
  if (const auto* recovery = std::get_if<RecoveryRequest>(&request)) return finder_.find(*recovery);
  return close_loop(std::get<ClosureRequest>(request), config_);
}

TrackedScan Mapper::track(const Scan& scan, const ScanPrior& prior) {
  TrackedScan tracked = tracker_.track(scan, prior);
  follow_archive();
  tracked.loop_closures = closures_;
  if (tracked.recovery && tracked.recovery->accepted) {
    pending_.reset();
    const ArchivedKeyframe& nearest = tracker_.archive().nearest(tracker_.own_from_body().translation());
    if (graph_.contains(nearest.id)) tracker_.set_drift(drift_at(nearest.id));
  }
  if (correction_ && !tracked.recovery) {
    correction_->map_from_body = tracked.map_from_body;
    correction_->epoch = tracked.epoch;
    tracked.recovery = std::exchange(correction_, std::nullopt);
  }
  return tracked;
}

/// Keyframes that the archive has added become nodes, and those that it has dropped leave.
void Mapper::follow_archive() {
  const std::vector<ArchivedKeyframe>& keyframes = tracker_.archive().keyframes();
  if (keyframes.empty() || keyframes.back().id < known_) return;
  for (const ArchivedKeyframe& k : keyframes) {
    if (k.id < known_) continue;
    const Pose map_from_keyframe = tracker_.map_from_own() * k.map_from_body;
    Constraint odometry;
    odometry.to = k.id;
    if (k.tie && graph_.contains(k.tie->before)) {
      odometry.from = k.tie->before;
      odometry.from_to = k.tie->before_from_here;
      odometry.information = inverse(k.tie->covariance);
    } else {
      graph_.add(kOrigin, Pose::Identity());
      odometry.from = kOrigin;
      odometry.from_to = map_from_keyframe;
      odometry.information = inverse(Matrix6(tracker_.drift() + kFloor * kFloor * Matrix6::Identity()));
    }
    graph_.add(k.id, map_from_keyframe);
    graph_.connect(odometry);
  }
  known_ = keyframes.back().id + 1;
  std::vector<std::uint32_t> gone;
  for (const auto& [id, pose] : graph_.nodes()) {
    if (id != kOrigin && !tracker_.archive().find(id)) gone.push_back(id);
  }
  for (const std::uint32_t id : gone) graph_.remove(id);
}

std::optional<MapRequest> Mapper::take_request() {
  if (out_) return std::nullopt;
  std::optional<MapRequest> request;
  if (auto recovery = tracker_.take_request()) {
    request = std::move(*recovery);
  } else if (auto closure = closure_request()) {
    request = std::move(*closure);
  }
  out_ = request.has_value();
  return request;
}

/// The newest keyframe, where an earlier visit was near by and the graph knows less of where the two lie to
/// each other than another closure would tell.
std::optional<ClosureRequest> Mapper::closure_request() {
  const std::vector<ArchivedKeyframe>& keyframes = tracker_.archive().keyframes();
  if (keyframes.empty() || !tracker_.on_known_ground()) return std::nullopt;
  const ArchivedKeyframe& newest = keyframes.back();
  if (asked_ == newest.id || !graph_.contains(newest.id)) return std::nullopt;
  asked_ = newest.id;
  const Eigen::Vector3d here = newest.map_from_body.translation();
  const auto reach = static_cast<double>(newest.reach);
  const std::int64_t since = tracker_.local_map_utime();
  ClosureRequest request;
  for (const ArchivedKeyframe& k : keyframes) {
    if (k.id == newest.id || (k.map_from_body.translation() - here).norm() > reach) continue;
    (k.utime < since ? request.earlier : request.recent).push_back(k);
  }
  if (request.earlier.empty() || request.recent.empty()) return std::nullopt;
  request.earlier = nearest_to(here, std::move(request.earlier));
  request.recent = nearest_to(here, std::move(request.recent));
  request.nearest = request.earlier.front().id;
  request.covariance = graph_.covariance(request.nearest, newest.id);
  if (!pending_ && size_of(request.covariance, reach) < kWorthwhile * size_of(told_, reach))
    return std::nullopt;
  request.serial = ++serial_;
  request.keyframe = newest;
  request.voxel = tracker_.voxel();
  request.planar = tracker_.planar();
  request.usual = tracker_.usual();
  return request;
}

void Mapper::give(MapAnswer answer) {
  out_ = false;
  if (auto* recovery = std::get_if<RecoveryAnswer>(&answer)) {
    tracker_.give(std::move(*recovery));
    return;
  }
  take_closure(std::get<ClosureAnswer>(answer));
}

void Mapper::take_closure(const ClosureAnswer& answer) {
  const Constraint& found = answer.constraint;
  if (answer.serial != serial_ || !graph_.contains(found.from) || !graph_.contains(found.to)) return;
  const std::optional<Constraint> before = std::exchange(pending_, std::nullopt);
  if (!answer.found) return;
  const bool there = before && graph_.contains(before->from) && graph_.contains(before->to);
  if (!there || !agree(*before, found)) {
    pending_ = found;
    return;
  }
  graph_.connect(*before);
  graph_.connect(found);
  told_ = inverse(found.information);
  ++closures_;
  bend();
}

/// Whether two closures say the same of how the two visits lie to each other, as far as they and the ways
/// between them are known.
bool Mapper::agree(const Constraint& a, const Constraint& b) const {
  const std::map<std::uint32_t, Pose>& at = graph_.nodes();
  const Pose a_from_b = at.at(a.to).inverse() * at.at(b.to);           // this visit
  const Pose from_a_from_b = at.at(a.from).inverse() * at.at(b.from);  // the earlier one
  const Vector6 apart = se3_log(b.from_to.inverse() * from_a_from_b.inverse() * a.from_to * a_from_b);
  const Matrix6 recent = adjoint(a_from_b.inverse()), earlier = adjoint(b.from_to.inverse());
  const Matrix6 covariance = recent * inverse(a.information) * recent.transpose() + inverse(b.information) +
                             graph_.covariance(a.to, b.to) +
                             earlier * graph_.covariance(a.from, b.from) * earlier.transpose();
  return apart.dot(inverse(covariance) * apart) < kOnceInThousand;
}

/// Brings the tracker's keyframes to the optimum. Its own frame stays with the robot and the scans around it;
/// what moves is the rest of the map, and the frame that poses are told in.
void Mapper::bend() {
  const std::uint32_t newest = tracker_.archive().keyframes().back().id;
  const Pose own_from_newest = tracker_.archive().keyframes().back().map_from_body;
  const Pose before = tracker_.map_from_own();
  graph_.optimise();
  const Pose map_from_own = renormalised(graph_.nodes().at(newest) * own_from_newest.inverse());
  std::map<std::uint32_t, Pose> own_from_keyframe;
  for (const auto& [id, pose] : graph_.nodes())
    own_from_keyframe.emplace(id, renormalised(map_from_own.inverse() * pose));
  const Pose here = tracker_.own_from_body();
  const bool jumps = !near(before * here, map_from_own * here, kJumpMetres, kJumpRadians);
  tracker_.correct(own_from_keyframe, map_from_own, drift_at(newest), jumps);
  if (!jumps) return;
  correction_ = Recovery();
  correction_->accepted = true;
  correction_->loop_closure = true;
  correction_->reason = "loop closure";
  correction_->map_from_predicted = map_from_own * before.inverse();
}

/// Covariance of the map around a keyframe against the first one, in the frame of the robot.
Matrix6 Mapper::drift_at(std::uint32_t keyframe) const {
  const Pose keyframe_from_map = graph_.nodes().at(keyframe).inverse();
  const Matrix6 onwards =
      adjoint((keyframe_from_map * tracker_.map_from_own() * tracker_.own_from_body()).inverse());
  return onwards * graph_.covariance(kOrigin, keyframe) * onwards.transpose();
}

void Mapper::reset() {
  tracker_.reset();
  graph_ = {};
  known_ = 0;
  asked_.reset();
  pending_.reset();
}

void Mapper::load(SavedMap saved) {
  reset();
  tracker_.load(std::move(saved));
  follow_archive();
}

}  // namespace scanlock
