// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Submaps of Mapper: beginning, entering, joining, saving and loading them.
#include <algorithm>
#include <utility>
#include <vector>

#include "mapping/mapper.hpp"

namespace scanlock {

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
  unnamed_.clear();
  revisits_.clear();
  joins_.begin();
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
  note_revisits(answer.closure.revisits);
  bend(answer.closure, own_from_fixed);
  told.accepted = true;
  told.reason.insert(0, "submaps joined: ");
  told.map_from_predicted = tracker_.map_from_own() * before.inverse();
  correction_ = told;
}

void Mapper::set_pose(const Pose& map_from_body) {
  const auto oldest = std::min_element(others_.begin(), others_.end(), is_older);
  if (!active_.located && oldest != others_.end())
    // The caller's pose is in the frame of the oldest one.
    enter(static_cast<std::size_t>(oldest - others_.begin()));
  tracker_.set_pose(map_from_body);
  located_ = true;
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

}  // namespace scanlock
