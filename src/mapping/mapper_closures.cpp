// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Loop closures of Mapper: requests, answers, and the correction of the map.
#include <map>
#include <utility>
#include <vector>

#include "mapping/mapper.hpp"

namespace scanlock {

/// A request for the newest keyframe, where keyframes of an earlier visit are within a reach.
std::optional<ClosureRequest> Mapper::closure_request() {
  const std::vector<ArchivedKeyframe>& keyframes = tracker_.archive().keyframes();
  if (keyframes.empty() || !tracker_.on_known_ground()) return std::nullopt;
  const ArchivedKeyframe& newest = keyframes.back();
  if (considered_ == newest.id || !active_.graph.contains(newest.id)) return std::nullopt;
  considered_ = newest.id;
  // Keyframes within a reach see the same surfaces: their closures share errors, and a second one adds
  // little.
  if (!pending_ && newest.id < asked_ + kTrail) return std::nullopt;
  ClosureRequest request = request_around(newest);
  if (request.earlier.empty() || request.recent.empty()) return std::nullopt;
  request.revisits = new_revisits();
  if (request.revisits.empty() || request.revisits.back().keyframe != newest.id) return std::nullopt;
  asked_ = newest.id;
  const ArchivedKeyframe& nearest = request.earlier.front();
  request.nearest = request.revisits.back().nearest;
  request.nearest_keyframe = nearest.id;
  request.own_from_nearest =
      request.nearest == kOriginNode ? Pose(tracker_.map_from_own().inverse()) : nearest.map_from_body;
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

/// The keyframes that no answer has named, each with the nearest one of an earlier visit; the newest last.
std::vector<Revisit> Mapper::new_revisits() const {
  const KeyframeArchive& archive = tracker_.archive();
  std::vector<Revisit> revisits;
  for (const auto& [id, visit_utime] : unnamed_) {
    const ArchivedKeyframe* k = archive.find(id);
    if (!k || !active_.graph.contains(id)) continue;
    const auto is_earlier = [&, k, utime = visit_utime](const ArchivedKeyframe& other) {
      return other.id < k->id && other.utime < utime;
    };
    const std::vector<ArchivedKeyframe> earlier = nearest_to(
        k->map_from_body.translation(), static_cast<double>(k->reach), archive.keyframes(), is_earlier, 1);
    if (earlier.empty()) continue;
    const std::uint32_t nearest = earlier.front().id;
    revisits.push_back({id, archive.is_fixed(nearest) ? kOriginNode : nearest, nearest});
  }
  return revisits;
}

void Mapper::note_revisits(const std::vector<Revisit>& revisits) {
  for (const Revisit& revisit : revisits) {
    revisits_[revisit.keyframe] = revisit;
    unnamed_.erase(revisit.keyframe);
  }
}

void Mapper::take_closure(const ClosureAnswer& answer) {
  tracker_.note_map_fault(answer.map_fault);
  const std::optional<Constraint> before = std::exchange(pending_, std::nullopt);
  if (answer.serial != serial_ || !active_.graph.contains(answer.nearest) ||
      !active_.graph.contains(answer.keyframe))
    return;
  if (answer.outcome == ClosureOutcome::kPending) pending_ = answer.closure;
  note_revisits(answer.revisits);
  if (answer.outcome != ClosureOutcome::kAccepted) return;
  if (before && active_.graph.contains(before->from) && active_.graph.contains(before->to))
    active_.graph.connect(*before);
  active_.graph.connect(answer.closure);
  bend(answer, tracker_.map_from_own().inverse());
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
  const bool jumps = is_jump(before * here, map_from_own * here);
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

}  // namespace scanlock
