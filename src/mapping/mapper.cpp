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

// Constraints on a path between two keyframes.
constexpr int kFewSteps = 4;
constexpr double kJumpMetres = 0.05, kJumpRadians = 0.5 * kDegree;  // a larger correction begins a new epoch

}  // namespace

TrackedScan Mapper::track(const Scan& scan, const ScanPrior& prior) {
  TrackedScan tracked = tracker_.track(scan, prior);
  if (tracker_.on_known_ground()) joins_.note_scan();
  const bool found = tracked.recovery && tracked.recovery->accepted;
  if (tracker_.submap() != submap_) begin_submap();
  if (found) return_to_submap(&tracked);
  tracked.localised = located_;
  follow_archive();
  tracked.loop_closures = closures_;
  if (history_ && !active_.graph.nodes().empty()) tracked.stamp = stamp();
  if (found) {
    pending_.reset();
    last_revisit_.reset();
    const ArchivedKeyframe& nearest = tracker_.archive().nearest(tracker_.own_from_body().translation());
    if (tracker_.archive().is_fixed(nearest.id))
      tracker_.set_drift(Matrix6::Zero());
    else if (active_.graph.contains(nearest.id))
      tracker_.set_drift(seen_from_robot(nearest.id, active_.graph.covariance(kOriginNode, nearest.id)));
  }
  if (correction_ && !tracked.recovery) {
    correction_->map_from_body = tracked.map_from_body;
    correction_->epoch = tracked.epoch;
    tracked.recovery = std::exchange(correction_, std::nullopt);
  }
  return tracked;
}

/// The poses of one run of lost-mode odometry share a stamp that stays open: once the robot is found all of
/// them get the same correction.
std::uint32_t Mapper::stamp() {
  const auto& [newest, pose] = *active_.graph.nodes().rbegin();
  const Pose map_from_local = tracker_.map_from_local();
  const int scans = tracker_.excursion_scans();
  if (scans == 0) {
    const bool is_same = open_ && open_->map_from_local.matrix() == map_from_local.matrix();
    const Pose correction =
        !open_ || is_same ? Pose::Identity() : Pose(map_from_local * open_->map_from_local.inverse());
    if (open_) history_->close(open_->stamp, correction, newest, pose);
    open_.reset();
    return history_->stamp(newest, pose);
  }
  if (!open_ || scans == 1) open_ = {history_->open(newest, pose), map_from_local};
  return open_->stamp;
}

/// Begins an empty active submap. The one before becomes one of the other submaps, which the archive has
/// moved away along x.
void Mapper::begin_submap() {
  submap_ = tracker_.submap();
  active_.own_from_map = tracker_.map_from_own().inverse();
  active_.graph.add(kOriginNode, Pose::Identity());  // the graph of a fixed map may have no other node
  others_.push_back(std::exchange(active_, Submap()));
  active_.located = located_;
  for (Submap& other : others_) other.own_from_map.translation().x() -= tracker_.moved_away();
  forget_revisits();
}

/// Enters the submap in which the robot was found, where it is not the one in which it was lost.
void Mapper::return_to_submap(TrackedScan* tracked) {
  const Eigen::Vector3d here = tracker_.own_from_body().translation();
  const ArchivedKeyframe* nearest = nullptr;
  for (const ArchivedKeyframe& k : tracker_.archive().keyframes()) {
    const auto distance = [&](const ArchivedKeyframe& a) {
      return (a.map_from_body.translation() - here).norm();
    };
    if (k.id < known_ && (!nearest || distance(k) < distance(*nearest))) nearest = &k;
  }
  if (!nearest) return;
  const std::optional<std::size_t> place =
      active_.graph.contains(nearest->id) ? std::nullopt : submap_of(nearest->id, others_);
  located_ = (place ? others_[*place] : active_).located;
  if (!place) return;
  const Pose before = tracker_.map_from_own();
  enter(*place);
  const Pose& now = tracker_.map_from_own();
  tracked->map_from_body = now * tracker_.own_from_body();
  tracked->recovery->map_from_body = tracked->map_from_body;
  tracked->recovery->map_from_predicted =
      renormalised(now * before.inverse() * tracked->recovery->map_from_predicted);
}

void Mapper::enter(std::size_t other) {
  active_.own_from_map = tracker_.map_from_own().inverse();
  std::swap(active_, others_[other]);
  tracker_.set_map_from_own(active_.own_from_map.inverse());
  forget_revisits();
}

void Mapper::forget_revisits() {
  ++serial_;  // answers to earlier requests are ignored: they concern another submap
  pending_.reset();
  last_revisit_.reset();
  revisits_.clear();
  joins_.begin();
}

std::optional<MapRequest> Mapper::take_request() {
  if (out_) return std::nullopt;
  std::optional<MapRequest> request;
  if (auto recovery = tracker_.take_request()) {
    request = std::move(*recovery);
  } else if (!unprepared_.empty() && !located_) {
    request = std::move(unprepared_.back());
    unprepared_.pop_back();
  } else if (auto closure = closure_request()) {
    request = std::move(*closure);
  } else if (auto join = join_request()) {
    request = std::move(*join);
  }
  out_ = request.has_value();
  return request;
}

/// A request for the newest keyframe, where keyframes of an earlier visit are within a reach.
std::optional<ClosureRequest> Mapper::closure_request() {
  const std::vector<ArchivedKeyframe>& keyframes = tracker_.archive().keyframes();
  if (keyframes.empty() || !tracker_.on_known_ground()) return std::nullopt;
  const ArchivedKeyframe& newest = keyframes.back();
  if (considered_ == newest.id || !active_.graph.contains(newest.id)) return std::nullopt;
  considered_ = newest.id;
  ClosureRequest request = request_around(newest);
  if (request.earlier.empty() || request.recent.empty()) return std::nullopt;
  const ArchivedKeyframe& nearest = request.earlier.front();
  const bool fixed = tracker_.archive().is_fixed(nearest.id);
  request.nearest = fixed ? kOriginNode : nearest.id;
  request.own_from_nearest = fixed ? Pose(tracker_.map_from_own().inverse()) : nearest.map_from_body;
  request.nearest_keyframe = nearest.id;
  if (is_known({newest.id, request.nearest, nearest.id})) return std::nullopt;
  // Keyframes within a reach see the same surfaces: their closures share errors, and a second one adds
  // little.
  if (!pending_ && newest.id < asked_ + kTrail) return std::nullopt;
  asked_ = newest.id;
  request.serial = ++serial_;
  request.graph = active_.graph;
  request.pending = pending_;
  request.usual_information = usual_information_;
  return request;
}

/// A keyframe of the active submap, with the keyframes around it.
ClosureRequest Mapper::request_around(const ArchivedKeyframe& keyframe) const {
  const std::vector<ArchivedKeyframe>& keyframes = tracker_.archive().keyframes();
  const Eigen::Vector3d here = keyframe.map_from_body.translation();
  const auto reach = static_cast<double>(keyframe.reach);
  const std::int64_t since = tracker_.local_map_utime();
  ClosureRequest request;
  request.earlier = nearest_to(here, reach, keyframes, [&](const ArchivedKeyframe& k) {
    return k.id != keyframe.id && k.utime < since;
  });
  request.recent = nearest_to(here, reach, keyframes, [&](const ArchivedKeyframe& k) {
    return k.id != keyframe.id && k.utime >= since;
  });
  request.keyframe = keyframe;
  request.voxel = tracker_.voxel();
  request.planar = tracker_.odometer().planar();
  request.usual = tracker_.odometer().usual();
  return request;
}

/// A search for the newest keyframe, where there are other submaps.
std::optional<JoinRequest> Mapper::join_request() {
  const std::vector<ArchivedKeyframe>& keyframes = tracker_.archive().keyframes();
  if (others_.empty() || keyframes.empty() || !tracker_.on_known_ground()) return std::nullopt;
  const ArchivedKeyframe& newest = keyframes.back();
  if (!active_.graph.contains(newest.id) || !joins_.is_due(newest.id)) return std::nullopt;
  std::optional<RecoveryRequest> search = joins_.next(
      newest.utime, tracker_.odometer().map(), tracker_.own_from_body(), static_cast<double>(newest.reach),
      tracker_.archive().without(active_.graph.nodes(), active_.fixed));
  if (!search) return std::nullopt;
  JoinRequest request;
  request.search = std::move(*search);
  request.closure = request_around(newest);
  request.closure.serial = ++serial_;
  request.active = active_;
  request.others = others_;
  request.finds = joins_.finds();
  return request;
}

/// Whether a closure would add little: the covariance of the last revisit, and those of the odometry paths
/// from it to both keyframes, bound the relative pose well enough. Notes the revisit.
bool Mapper::is_known(Revisit revisit) {
  if (pending_ || !last_revisit_) return false;
  const std::optional<Constraint> earlier =
                                      active_.graph.way(revisit.nearest, last_revisit_->nearest, kFewSteps),
                                  recent =
                                      active_.graph.way(last_revisit_->keyframe, revisit.keyframe, kFewSteps);
  if (!earlier || !recent) return false;
  Constraint between;
  between.from_to = earlier->from_to.inverse() * active_.graph.nodes().at(revisit.nearest).inverse() *
                    active_.graph.nodes().at(revisit.keyframe) * recent->from_to.inverse();
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
  if (const auto* closure = std::get_if<ClosureAnswer>(&answer)) return take_closure(*closure);
  if (const auto* join = std::get_if<JoinAnswer>(&answer)) take_join(*join);
}

void Mapper::take_closure(const ClosureAnswer& answer) {
  tracker_.note_map_fault(answer.map_fault);
  const std::optional<Constraint> before = std::exchange(pending_, std::nullopt);
  if (answer.serial != serial_ || !active_.graph.contains(answer.nearest) ||
      !active_.graph.contains(answer.keyframe))
    return;
  const std::uint32_t before_keyframe = std::exchange(pending_keyframe_, answer.nearest_keyframe);
  if (answer.outcome == ClosureOutcome::kPending) pending_ = answer.closure;
  if (answer.outcome == ClosureOutcome::kKnown || answer.outcome == ClosureOutcome::kAccepted) {
    if (before) note_revisit({before->to, before->from, before_keyframe, answer.covariance});
    note_revisit({answer.keyframe, answer.nearest, answer.nearest_keyframe, answer.covariance});
  }
  if (answer.outcome != ClosureOutcome::kAccepted) return;
  if (before && active_.graph.contains(before->from) && active_.graph.contains(before->to))
    active_.graph.connect(*before);
  active_.graph.connect(answer.closure);
  bend(answer, tracker_.map_from_own().inverse());
}

/// Publishes the result of the search; where it is accepted, joins both submaps in the frame of the older.
void Mapper::take_join(const JoinAnswer& answer) {
  joins_.take(answer);
  tracker_.note_map_fault(answer.closure.map_fault);
  const Pose before = tracker_.map_from_own();
  Recovery told;
  told.search = answer.search;
  told.reason = answer.closure.outcome == ClosureOutcome::kPending ? "another search has to agree: " : "";
  told.reason += answer.closure.reason;
  told.map_from_predicted = renormalised(before * answer.search.map_from_predicted * before.inverse());
  correction_ = told;
  const Constraint& closure = answer.closure.closure;
  if (answer.closure.outcome == ClosureOutcome::kRefused || answer.closure.serial != serial_ ||
      !active_.graph.contains(closure.to))
    return;
  const std::optional<std::size_t> place = submap_of(answer.closure.nearest_keyframe, others_);
  if (!place || !others_[*place].graph.contains(closure.from)) return;
  if (answer.closure.outcome == ClosureOutcome::kPending) {
    joins_.remember({closure, answer.closure.nearest_keyframe, answer.search.log_odds});
    return;
  }
  const Submap other = std::move(others_[*place]);
  others_.erase(others_.begin() + static_cast<std::ptrdiff_t>(*place));
  const Pose own_from_fixed = other.fixed ? other.own_from_map : Pose(tracker_.map_from_own().inverse());
  active_.graph = joined(active_, other, closure);
  active_.fixed = active_.fixed || other.fixed;
  active_.located = active_.located || other.located;
  located_ = active_.located;
  for (const Constraint& c : answer.agreeing) {
    if (active_.graph.contains(c.from) && active_.graph.contains(c.to)) active_.graph.connect(c);
  }
  active_.graph.connect(closure);
  forget_revisits();
  note_revisit(
      {answer.closure.keyframe, closure.from, answer.closure.nearest_keyframe, answer.closure.covariance});
  bend(answer.closure, own_from_fixed);
  told.accepted = true;
  told.reason.insert(0, "submaps joined: ");
  told.map_from_predicted = tracker_.map_from_own() * before.inverse();
  correction_ = told;
}

/// Moves the tracker's keyframes to the optimum. In the tracker's own frame the newest keyframe stays where
/// it is and the others move; map_from_own moves, by which poses are published.
void Mapper::bend(const ClosureAnswer& answer, const Pose& own_from_fixed) {
  PoseGraph& graph = active_.graph;
  const ArchivedKeyframe* newest = tracker_.archive().find(graph.nodes().rbegin()->first);
  if (!newest) return;
  usual_information_ = answer.closure.information;
  ++closures_;
  const Pose before = tracker_.map_from_own();
  graph.move(answer.map_from_node);
  const Pose map_from_own = renormalised(graph.nodes().at(newest->id) * newest->map_from_body.inverse());
  std::map<std::uint32_t, Pose> own_from_keyframe;
  for (const auto& [id, pose] : graph.nodes())
    own_from_keyframe.emplace(id, renormalised(map_from_own.inverse() * pose));
  if (active_.fixed) {
    const Pose now_from_before = map_from_own.inverse() * own_from_fixed.inverse();
    for (const ArchivedKeyframe& k : tracker_.archive().keyframes()) {
      if (!tracker_.archive().is_fixed(k.id)) break;
      own_from_keyframe.emplace(k.id, renormalised(now_from_before * k.map_from_body));
    }
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

/// A covariance of a keyframe's pose, in its frame, as one of the robot's pose, in the robot's frame.
Matrix6 Mapper::seen_from_robot(std::uint32_t keyframe, const Matrix6& covariance) const {
  const Pose map_from_robot = tracker_.map_from_own() * tracker_.own_from_body();
  const Matrix6 onwards = adjoint(map_from_robot.inverse() * active_.graph.nodes().at(keyframe));
  return onwards * covariance * onwards.transpose();
}

Pose Mapper::correction(std::uint32_t stamp) const {
  if (!history_) return Pose::Identity();
  return history_->correction(stamp, [this](std::uint32_t keyframe) {
    const auto is_there = [&](const Submap& submap) { return submap.graph.contains(keyframe); };
    const auto other = std::find_if(others_.begin(), others_.end(), is_there);
    return (other == others_.end() ? active_ : *other).graph.nodes().at(keyframe);
  });
}

void Mapper::set_pose(const Pose& map_from_body) {
  const auto oldest = std::min_element(others_.begin(), others_.end(), is_older);
  if (!active_.located && oldest != others_.end())
    // The caller's pose is in the frame of the oldest one.
    enter(static_cast<std::size_t>(oldest - others_.begin()));
  tracker_.set_pose(map_from_body);
  located_ = true;
}

void Mapper::reset() {
  tracker_.reset();
  others_.push_back(std::exchange(active_, Submap()));
  if (history_) {
    for (const Submap& submap : others_)
      for (const auto& [id, pose] : submap.graph.nodes()) history_->remove(id, pose);
  }
  others_.clear();
  submap_ = tracker_.submap();
  known_ = considered_ = asked_ = 0;
  located_ = true;
  forget_revisits();
  correction_.reset();
  unprepared_.clear();
  open_.reset();
}

SavedMap Mapper::save() const {
  Submap active = active_;
  active.own_from_map = tracker_.map_from_own().inverse();
  return saved_map(tracker_.save(), active, others_);
}

void Mapper::load(SavedMap saved, bool fixed) {
  reset();
  if (fixed) saved = first_submap(std::move(saved));
  located_ = saved.keyframes.empty();
  active_.fixed = fixed && !located_;
  const auto keyframes = static_cast<std::uint32_t>(saved.keyframes.size());
  if (fixed || saved.constraints.empty()) {
    tracker_.load(std::move(saved), fixed);
    if (fixed) known_ = keyframes + 1;
    follow_archive();
    prepare_searches();
    return;
  }
  std::vector<Submap> submaps = submaps_of(saved);
  for (std::size_t i = 1; i < submaps.size(); ++i) {
    const Eigen::Vector3d away(-kSubmapsApart * static_cast<double>(i), 0, 0);
    submaps[i].own_from_map = Eigen::Translation3d(away);
    submaps[i].located = false;
    for (const auto& [id, pose] : submaps[i].graph.nodes())
      if (id != kOriginNode) saved.keyframes[id - 1].map_from_body = submaps[i].own_from_map * pose;
  }
  tracker_.load(std::move(saved), false);
  for (Submap& submap : submaps)
    submap.own_from_map = tracker_.map_from_own().inverse() * submap.own_from_map;
  active_ = std::move(submaps.front());
  submaps.erase(submaps.begin());
  others_ = std::move(submaps);
  known_ = keyframes + 1;
  drop_evicted();
  prepare_searches();
}

void Mapper::prepare_searches() {
  unprepared_ = PlaceSearch::first_targets(tracker_.archive());
  std::reverse(unprepared_.begin(), unprepared_.end());
}

}  // namespace scanlock
