// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/mapper.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace scanlock {

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
  const int scans = tracker_.lost_odometry_scans();
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

void Mapper::give(MapAnswer answer) {
  out_ = false;
  if (auto* recovery = std::get_if<RecoveryAnswer>(&answer)) {
    tracker_.give(std::move(*recovery));
    return;
  }
  if (const auto* closure = std::get_if<ClosureAnswer>(&answer)) return take_closure(*closure);
  if (const auto* join = std::get_if<JoinAnswer>(&answer)) take_join(*join);
}

Pose Mapper::correction(std::uint32_t stamp) const {
  if (!history_) return Pose::Identity();
  return history_->correction(stamp, [this](std::uint32_t keyframe) {
    const auto is_there = [&](const Submap& submap) { return submap.graph.contains(keyframe); };
    const auto other = std::find_if(others_.begin(), others_.end(), is_there);
    return (other == others_.end() ? active_ : *other).graph.nodes().at(keyframe);
  });
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

void Mapper::prepare_searches() {
  unprepared_ = PlaceSearch::first_targets(tracker_.archive());
  std::reverse(unprepared_.begin(), unprepared_.end());
}

}  // namespace scanlock
