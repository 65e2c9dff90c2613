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

constexpr std::size_t kMostAround = 20;  // keyframes that make one side of a closure: a cap on its cost
constexpr auto kTrail = static_cast<std::uint32_t>(1 / kPlaceSpacing);  // keyframes of one reach of way
constexpr int kFewSteps = 4;                                            // constraints of a way
constexpr double kJumpMetres = 0.05, kJumpRadians = 0.5 * kDegree;      // more is told as a new epoch

std::vector<ArchivedKeyframe> nearest_to(const Eigen::Vector3d& position,
                                         std::vector<ArchivedKeyframe> some) {
  std::stable_sort(some.begin(), some.end(), [&](const ArchivedKeyframe& a, const ArchivedKeyframe& b) {
    return (a.map_from_body.translation() - position).squaredNorm() <
           (b.map_from_body.translation() - position).squaredNorm();
  });
  some.resize(std::min(some.size(), kMostAround));
  return some;
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
  if (history_ && !graph_.nodes().empty()) {
    const auto& [newest, pose] = *graph_.nodes().rbegin();
    tracked.stamp = history_->stamp(newest, pose);
  }
  if (tracked.recovery && tracked.recovery->accepted) {
    pending_.reset();
    last_revisit_.reset();
    const ArchivedKeyframe& nearest = tracker_.archive().nearest(tracker_.own_from_body().translation());
    if (tracker_.archive().is_fixed(nearest.id))
      tracker_.set_drift(Matrix6::Zero());
    else if (graph_.contains(nearest.id))
      tracker_.set_drift(seen_from_robot(nearest.id, graph_.covariance(kOriginNode, nearest.id)));
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
    if (k.id >= known_) connect_odometry(k);
  }
  known_ = keyframes.back().id + 1;
  drop_evicted();
  renew_places();
}

/// To the keyframe before, to the map's frame where that is fixed, or where there is none.
void Mapper::connect_odometry(const ArchivedKeyframe& keyframe) {
  const Pose map_from_keyframe = tracker_.map_from_own() * keyframe.map_from_body;
  graph_.add(kOriginNode, Pose::Identity());
  graph_.add(keyframe.id, map_from_keyframe);
  Constraint tie;
  if (keyframe.tie) tie = *keyframe.tie;
  if (keyframe.tie && graph_.contains(tie.from)) {
    graph_.connect(tie);
    return;
  }
  const ArchivedKeyframe* before = keyframe.tie ? tracker_.archive().find(tie.from) : nullptr;
  if (before && tracker_.archive().is_fixed(before->id)) {
    tie.from_to = tracker_.map_from_own() * before->map_from_body * tie.from_to;
  } else {
    tie.from_to = map_from_keyframe;
    tie.information = inverse(Matrix6(tracker_.drift() + kPoseFloor * kPoseFloor * Matrix6::Identity()));
  }
  tie.from = kOriginNode;
  tie.to = keyframe.id;
  graph_.connect(tie);
}

void Mapper::drop_evicted() {
  std::vector<std::uint32_t> gone;
  for (const auto& [id, pose] : graph_.nodes()) {
    if (id != kOriginNode && !tracker_.archive().find(id)) gone.push_back(id);
  }
  for (const std::uint32_t id : gone) {
    if (history_) history_->remove(id, graph_.nodes().at(id));
    graph_.remove(id);
  }
}

/// Keyframes that lie a reach behind the robot take the place of those of an earlier visit. Not while a
/// closure is worked on: its answer has poses of the nodes as they are.
void Mapper::renew_places() {
  if (out_) return;
  while (!revisits_.empty() && revisits_.begin()->first + kTrail <= known_) {
    const auto [id, revisit] = *revisits_.begin();
    revisits_.erase(revisits_.begin());
    renew(id, revisit);
  }
}

/// Of a map that is fixed the older one stays.
void Mapper::renew(std::uint32_t id, const Revisit& revisit) {
  const ArchivedKeyframe* newer = tracker_.archive().find(id);
  const ArchivedKeyframe* old = tracker_.archive().find(revisit.nearest_keyframe);
  if (!newer || !old || !graph_.contains(id) || !graph_.contains(revisit.nearest)) return;
  const double apart = (newer->map_from_body.translation() - old->map_from_body.translation()).norm();
  const double unsure = 3 * std::sqrt(revisit.covariance.diagonal().head<3>().maxCoeff());
  if (std::max(apart, unsure) > kSameSpot * static_cast<double>(newer->reach)) return;
  if (tracker_.archive().is_fixed(old->id)) {
    if (history_) history_->remove(id, graph_.nodes().at(id));
    graph_.remove(id);
    tracker_.remove(id);
  } else {
    if (history_) history_->renew(old->id, id, graph_.nodes().at(old->id).inverse() * graph_.nodes().at(id));
    graph_.renew(old->id, id, revisit.covariance);
    tracker_.renew(old->id, id);
    for (auto& [other, at] : revisits_) {
      if (at.nearest == id) at.nearest = at.nearest_keyframe = revisit.nearest;
    }
  }
  if (last_revisit_ && (last_revisit_->keyframe == id || last_revisit_->nearest == id)) last_revisit_.reset();
  if (pending_ && (pending_->from == id || pending_->to == id)) pending_.reset();
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

/// For the newest keyframe, where an earlier visit was near by.
std::optional<ClosureRequest> Mapper::closure_request() {
  const std::vector<ArchivedKeyframe>& keyframes = tracker_.archive().keyframes();
  if (keyframes.empty() || !tracker_.on_known_ground()) return std::nullopt;
  const ArchivedKeyframe& newest = keyframes.back();
  if (considered_ == newest.id || !graph_.contains(newest.id)) return std::nullopt;
  considered_ = newest.id;
  const Eigen::Vector3d here = newest.map_from_body.translation();
  const std::int64_t since = tracker_.local_map_utime();
  ClosureRequest request;
  for (const ArchivedKeyframe& k : keyframes) {
    const double distance = (k.map_from_body.translation() - here).norm();
    if (k.id == newest.id || distance > static_cast<double>(newest.reach)) continue;
    (k.utime < since ? request.earlier : request.recent).push_back(k);
  }
  if (request.earlier.empty() || request.recent.empty()) return std::nullopt;
  request.earlier = nearest_to(here, std::move(request.earlier));
  request.recent = nearest_to(here, std::move(request.recent));
  const ArchivedKeyframe& nearest = request.earlier.front();
  const bool fixed = tracker_.archive().is_fixed(nearest.id);
  request.nearest = fixed ? kOriginNode : nearest.id;
  request.own_from_nearest = fixed ? Pose(tracker_.map_from_own().inverse()) : nearest.map_from_body;
  request.nearest_keyframe = nearest.id;
  if (is_known({newest.id, request.nearest, nearest.id})) return std::nullopt;
  // Keyframes within a reach see the same surfaces: their closures share their errors, and say little more.
  if (!pending_ && newest.id < asked_ + kTrail) return std::nullopt;
  asked_ = newest.id;
  request.graph = graph_;
  request.serial = ++serial_;
  request.keyframe = newest;
  request.pending = pending_;
  request.usual_information = usual_information_;
  request.voxel = tracker_.voxel();
  request.planar = tracker_.planar();
  request.usual = tracker_.usual();
  return request;
}

/// Whether the two visits lie to each other as they did at the keyframe before, to within the ways from
/// there.
bool Mapper::is_known(Revisit revisit) {
  if (pending_ || !last_revisit_) return false;
  const std::optional<Constraint> earlier = graph_.way(revisit.nearest, last_revisit_->nearest, kFewSteps),
                                  recent = graph_.way(last_revisit_->keyframe, revisit.keyframe, kFewSteps);
  if (!earlier || !recent) return false;
  Constraint between;
  between.from_to = earlier->from_to.inverse() * graph_.nodes().at(revisit.nearest).inverse() *
                    graph_.nodes().at(revisit.keyframe) * recent->from_to.inverse();
  between.information = inverse(last_revisit_->covariance);
  revisit.covariance = inverse(chained(chained(*earlier, between), *recent).information);
  note_revisit(revisit);
  return !is_worthwhile(revisit.covariance, usual_information_);
}

void Mapper::note_revisit(const Revisit& revisit) {
  last_revisit_ = revisit;
  revisits_[revisit.keyframe] = revisit;
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
  const std::optional<Constraint> before = std::exchange(pending_, std::nullopt);
  if (answer.serial != serial_ || !graph_.contains(answer.nearest) || !graph_.contains(answer.keyframe))
    return;
  const std::uint32_t before_keyframe = std::exchange(pending_keyframe_, answer.nearest_keyframe);
  if (answer.outcome == ClosureOutcome::kPending) pending_ = answer.closure;
  if (answer.outcome == ClosureOutcome::kKnown || answer.outcome == ClosureOutcome::kAccepted) {
    if (before) note_revisit({before->to, before->from, before_keyframe, answer.covariance});
    note_revisit({answer.keyframe, answer.nearest, answer.nearest_keyframe, answer.covariance});
  }
  if (answer.outcome != ClosureOutcome::kAccepted) return;
  if (before && graph_.contains(before->from) && graph_.contains(before->to)) graph_.connect(*before);
  graph_.connect(answer.closure);
  usual_information_ = answer.closure.information;
  ++closures_;
  bend(answer);
}

/// Brings the tracker's keyframes to the optimum. Its own frame stays with the robot and the scans around it;
/// what moves is the rest of the map, and the frame that poses are told in.
void Mapper::bend(const ClosureAnswer& answer) {
  const ArchivedKeyframe& newest = tracker_.archive().keyframes().back();
  const Pose before = tracker_.map_from_own();
  graph_.move(answer.map_from_node);
  const Pose map_from_own = renormalised(graph_.nodes().at(newest.id) * newest.map_from_body.inverse());
  std::map<std::uint32_t, Pose> own_from_keyframe;
  for (const auto& [id, pose] : graph_.nodes())
    own_from_keyframe.emplace(id, renormalised(map_from_own.inverse() * pose));
  const Pose own_from_fixed = map_from_own.inverse() * before;
  for (const ArchivedKeyframe& k : tracker_.archive().keyframes()) {
    if (!tracker_.archive().is_fixed(k.id)) break;
    own_from_keyframe.emplace(k.id, renormalised(own_from_fixed * k.map_from_body));
  }
  const Pose here = tracker_.own_from_body();
  const bool jumps = !near(before * here, map_from_own * here, kJumpMetres, kJumpRadians);
  tracker_.correct(own_from_keyframe, map_from_own, seen_from_robot(answer.keyframe, answer.drift), jumps);
  if (!jumps) return;
  correction_ = Recovery();
  correction_->accepted = true;
  correction_->loop_closure = true;
  correction_->reason = "loop closure: " + answer.reason;
  correction_->map_from_predicted = map_from_own * before.inverse();
}

/// A covariance of a keyframe, in its frame, as one of the robot.
Matrix6 Mapper::seen_from_robot(std::uint32_t keyframe, const Matrix6& covariance) const {
  const Pose map_from_robot = tracker_.map_from_own() * tracker_.own_from_body();
  const Matrix6 onwards = adjoint(map_from_robot.inverse() * graph_.nodes().at(keyframe));
  return onwards * covariance * onwards.transpose();
}

Pose Mapper::correction(std::uint32_t stamp) const {
  return history_ ? history_->correction(stamp, graph_.nodes()) : Pose::Identity();
}

void Mapper::reset() {
  tracker_.reset();
  if (history_) {
    for (const auto& [id, pose] : graph_.nodes()) history_->remove(id, pose);
  }
  graph_ = {};
  ++serial_;  // an answer to come is of the map that is gone
  known_ = 0;
  considered_ = asked_ = 0;
  pending_.reset();
  last_revisit_.reset();
  revisits_.clear();
  correction_.reset();
}

/// Constraints name keyframes by their ids, the file by their places.
SavedMap Mapper::save() const {
  SavedMap saved = tracker_.save();
  std::map<std::uint32_t, std::uint32_t> places = {{kOriginNode, kOriginNode}};
  for (const ArchivedKeyframe& k : saved.keyframes)
    places.emplace(k.id, static_cast<std::uint32_t>(places.size()));
  for (Constraint c : graph_.constraints()) {
    const auto from = places.find(c.from), to = places.find(c.to);
    if (from == places.end() || to == places.end()) continue;
    c.from = from->second;
    c.to = to->second;
    saved.constraints.push_back(c);
  }
  return saved;
}

void Mapper::load(SavedMap saved, bool fixed) {
  reset();
  PoseGraph graph;
  if (!saved.constraints.empty() && !fixed) {
    graph.add(kOriginNode, Pose::Identity());
    std::uint32_t id = 0;
    for (const ArchivedKeyframe& k : saved.keyframes) graph.add(++id, k.map_from_body);
    for (const Constraint& c : saved.constraints) graph.connect(c);
  }
  const bool whole = graph.is_connected();
  const auto keyframes = static_cast<std::uint32_t>(saved.keyframes.size());
  tracker_.load(std::move(saved), fixed);
  if (fixed) {
    known_ = keyframes + 1;
    return;
  }
  if (whole && keyframes > 0 && !graph.nodes().empty()) {
    graph_ = std::move(graph);
    known_ = keyframes + 1;
    drop_evicted();
    return;
  }
  follow_archive();
}

}  // namespace scanlock
