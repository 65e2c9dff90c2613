// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Adds the archive's keyframes to the pose graph, and removes evicted and redundant ones:
// Mapper::follow_archive.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "global/hypothesis.hpp"
#include "mapping/mapper.hpp"
#include "odometry/scan_view.hpp"

namespace scanlock {
namespace {

/// The greater share (0 to 1) of one keyframe's points that contradict the other one's range image.
double contradiction(const ArchivedKeyframe& a, const ArchivedKeyframe& b) {
  const Pose a_from_b = a.map_from_body.inverse() * b.map_from_body;
  const std::shared_ptr<const PointCloud> a_points = a.points.cloud(), b_points = b.points.cloud();
  const ScanView a_view(*a_points), b_view(*b_points);
  return std::max(a_view.contradicted_share(*b_points, a_from_b, b_view),
                  b_view.contradicted_share(*a_points, a_from_b.inverse(), a_view));
}

}  // namespace

/// Adds nodes for new keyframes of the archive, and removes nodes of keyframes that it has dropped.
void Mapper::follow_archive() {
  const std::vector<ArchivedKeyframe>& keyframes = tracker_.archive().keyframes();
  if (keyframes.empty() || keyframes.back().id < known_) return;
  for (const ArchivedKeyframe& k : keyframes) {
    if (k.id >= known_) connect_odometry(k);
  }
  known_ = keyframes.back().id + 1;
  if (tracker_.on_known_ground()) unnamed_[keyframes.back().id] = tracker_.local_map_utime();
  if (unnamed_.size() > 2 * kTrail) unnamed_.erase(unnamed_.begin());
  drop_evicted();
  drop_redundant();
}

/// Connects a keyframe to the one before; to the map's frame where that one is fixed, or where there is none.
void Mapper::connect_odometry(const ArchivedKeyframe& keyframe) {
  const Pose map_from_keyframe = tracker_.map_from_own() * keyframe.map_from_body;
  active_.graph.add(kOriginNode, Pose::Identity());
  active_.graph.add(keyframe.id, map_from_keyframe);
  Constraint constraint;
  if (keyframe.constraint) constraint = *keyframe.constraint;
  if (keyframe.constraint && active_.graph.contains(constraint.from)) {
    active_.graph.connect(constraint);
    return;
  }
  const ArchivedKeyframe* before = keyframe.constraint ? tracker_.archive().find(constraint.from) : nullptr;
  if (before && tracker_.archive().is_fixed(before->id)) {
    constraint.from_to = tracker_.map_from_own() * before->map_from_body * constraint.from_to;
  } else {
    constraint.from_to = map_from_keyframe;
    constraint.information =
        inverse(Matrix6(tracker_.odometer().drift() + kPoseFloor * kPoseFloor * Matrix6::Identity()));
  }
  constraint.from = kOriginNode;
  constraint.to = keyframe.id;
  active_.graph.connect(constraint);
}

void Mapper::drop_evicted() {
  const auto drop = [&](PoseGraph& graph) {
    std::vector<std::uint32_t> gone;
    for (const auto& [id, pose] : graph.nodes()) {
      if (id != kOriginNode && !tracker_.archive().find(id)) gone.push_back(id);
    }
    for (const std::uint32_t id : gone) {
      if (history_) history_->remove(id, graph.nodes().at(id));
      graph.remove(id);
    }
  };
  drop(active_.graph);
  for (Submap& other : others_) drop(other.graph);
  const auto is_empty = [](const Submap& other) { return !other.fixed && other.graph.nodes().size() < 2; };
  others_.erase(std::remove_if(others_.begin(), others_.end(), is_empty), others_.end());
}

/// Of a keyframe a reach or more behind the robot and the keyframe of an earlier visit that shows the same
/// ground, keeps one. Not while a request is being worked on: its answer has poses of the present nodes.
void Mapper::drop_redundant() {
  if (out_) return;
  while (!revisits_.empty() && revisits_.begin()->first + kTrail <= known_) {
    const auto [id, revisit] = *revisits_.begin();
    revisits_.erase(revisits_.begin());
    drop_redundant(id, revisit);
  }
}

/// Keeps the older keyframe: a map that is always measured against its first keyframes does not drift. Where
/// more than 2.5 % of the points of either contradict the other the place has changed, and the newer keyframe
/// is kept.
void Mapper::drop_redundant(std::uint32_t id, const Revisit& revisit) {
  const ArchivedKeyframe* newer = tracker_.archive().find(id);
  const ArchivedKeyframe* old = tracker_.archive().find(revisit.nearest_keyframe);
  if (!newer || !old || !active_.graph.contains(id) || !active_.graph.contains(revisit.nearest)) return;
  const double apart = (newer->map_from_body.translation() - old->map_from_body.translation()).norm();
  const double unsure = 3 * std::sqrt(revisit.covariance.diagonal().head<3>().maxCoeff());
  if (std::max(apart, unsure) > kSameSpot * static_cast<double>(newer->reach)) return;
  const bool fixed = tracker_.archive().is_fixed(old->id);
  bool changed = false;
  try {
    changed = !fixed && contradiction(*old, *newer) > kClearContradiction;
  } catch (const PointsUnreadable& error) {
    tracker_.note_map_fault(error.what());
    return;  // both keyframes are kept
  }
  const std::uint32_t gone = changed ? revisit.nearest : id, kept = changed ? id : revisit.nearest;
  Constraint between;
  between.from = revisit.nearest;
  between.to = id;
  between.from_to = active_.graph.nodes().at(between.from).inverse() * active_.graph.nodes().at(between.to);
  between.information = inverse(revisit.covariance);
  if (history_ && fixed)
    history_->remove(gone, active_.graph.nodes().at(gone));
  else if (history_)
    history_->replace(gone, kept, active_.graph.nodes().at(kept).inverse() * active_.graph.nodes().at(gone));
  active_.graph.replace(gone, between);
  const std::uint32_t kept_keyframe = changed ? id : old->id;
  tracker_.replace(gone, kept_keyframe);
  revisits_.erase(gone);
  for (auto& [other, at] : revisits_) {
    if (at.nearest != gone) continue;
    at.nearest = kept;
    at.nearest_keyframe = kept_keyframe;
    at.covariance += revisit.covariance;
  }
  if (pending_ && (pending_->from == gone || pending_->to == gone)) pending_.reset();
}

}  // namespace scanlock
