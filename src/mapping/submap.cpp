// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/submap.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "odometry/tracking_promise.hpp"

namespace scanlock {
namespace {

constexpr int kAgreeing = 1, kPlanarAgreeing = 3;  // earlier finds: in a plane one room is soon like another

std::uint32_t first_keyframe(const Submap& submap) {
  const auto first = submap.graph.nodes().upper_bound(kOriginNode);
  return first == submap.graph.nodes().end() ? kOriginNode : first->first;
}

/// How far a search of that resolution may be off.
Matrix6 resolution(const RecoveryRequest& search, double reach) {
  Vector6 sigma;
  sigma << Eigen::Vector3d::Constant(search.voxel), Eigen::Vector3d::Constant(search.voxel / reach);
  return sigma.cwiseAbs2().asDiagonal();
}

PoseGraph merged(const PoseGraph& older, PoseGraph newer, const Pose& older_from_newer) {
  newer.remove(kOriginNode);
  PoseGraph both = older;
  for (const auto& [node, pose] : newer.nodes()) both.add(node, renormalised(older_from_newer * pose));
  for (const Constraint& c : newer.constraints()) both.connect(c);
  return both;
}

}  // namespace

bool is_older(const Submap& a, const Submap& b) {
  if (a.fixed != b.fixed) return a.fixed;
  return first_keyframe(a) < first_keyframe(b);
}

std::optional<std::size_t> submap_of(std::uint32_t keyframe, const std::vector<Submap>& submaps) {
  for (std::size_t i = 0; i < submaps.size(); ++i)
    if (submaps[i].graph.contains(keyframe)) return i;
  for (std::size_t i = 0; i < submaps.size(); ++i)
    if (submaps[i].fixed) return i;
  return std::nullopt;
}

SavedMap saved_map(const SavedMap& map, const Submap& active, const std::vector<Submap>& others) {
  std::vector<Submap> submaps = others;
  submaps.push_back(active);
  std::stable_sort(submaps.begin(), submaps.end(), is_older);
  SavedMap saved = map;
  saved.keyframes.clear();
  std::map<std::uint32_t, std::uint32_t> places = {{kOriginNode, kOriginNode}};
  for (const ArchivedKeyframe& k : map.keyframes) {
    const std::optional<std::size_t> place = submap_of(k.id, submaps);
    const bool is_alone = place.value_or(0) > 0 && submaps[*place].graph.nodes().size() < 3;
    if (is_alone) continue;
    places.emplace(k.id, static_cast<std::uint32_t>(places.size()));
    SavedMap one;
    one.keyframes.push_back(k);
    const bool is_elsewhere = place && !active.graph.contains(k.id) && !(active.fixed && *place == 0);
    if (is_elsewhere) one = moved(one, submaps[*place].own_from_map.inverse() * active.own_from_map);
    saved.keyframes.push_back(std::move(one.keyframes.front()));
  }
  for (Submap& submap : submaps) {
    if (&submap != &submaps.front()) submap.graph.remove(kOriginNode);
    for (Constraint c : submap.graph.constraints()) {
      const auto from = places.find(c.from), to = places.find(c.to);
      if (from == places.end() || to == places.end()) continue;
      c.from = from->second;
      c.to = to->second;
      saved.constraints.push_back(c);
    }
  }
  return saved;
}

std::vector<Submap> submaps_of(const SavedMap& saved) {
  PoseGraph graph;
  graph.add(kOriginNode, Pose::Identity());
  std::uint32_t id = 0;
  for (const ArchivedKeyframe& k : saved.keyframes) graph.add(++id, k.map_from_body);
  for (const Constraint& c : saved.constraints) graph.connect(c);
  std::vector<Submap> submaps;
  for (PoseGraph& part : graph.parts()) {
    const auto [first, pose] = *part.nodes().begin();
    Constraint tie;
    tie.to = first;
    tie.from_to = pose;
    tie.information = Matrix6::Identity() / (kPoseFloor * kPoseFloor);
    const bool is_single = part.nodes().size() == 1 && first != kOriginNode;
    if (!is_single) submaps.emplace_back().graph = std::move(part);
    PoseGraph& of_tie = is_single ? submaps.front().graph : submaps.back().graph;
    if (first == kOriginNode) continue;
    of_tie.add(kOriginNode, Pose::Identity());
    of_tie.add(first, pose);
    of_tie.connect(tie);
  }
  return submaps;
}

SavedMap first_submap(SavedMap saved) {
  if (saved.constraints.empty()) return saved;
  const PoseGraph graph = submaps_of(saved).front().graph;
  std::vector<ArchivedKeyframe> kept;
  for (std::size_t i = 0; i < saved.keyframes.size(); ++i)
    if (graph.contains(static_cast<std::uint32_t>(i + 1))) kept.push_back(saved.keyframes[i]);
  saved.keyframes = std::move(kept);
  saved.constraints.clear();
  return saved;
}

PoseGraph joined(const Submap& active, const Submap& other, const Constraint& closure) {
  const Pose other_from_active = renormalised(other.graph.nodes().at(closure.from) * closure.from_to *
                                              active.graph.nodes().at(closure.to).inverse());
  return is_older(other, active) ? merged(other.graph, active.graph, other_from_active)
                                 : merged(active.graph, other.graph, other_from_active.inverse());
}

JoinAnswer join_submaps(const JoinRequest& request, PlaceFinder& finder, const TrackerConfig& config) {
  JoinAnswer answer;
  answer.search = finder.find(request.search);
  answer.closure.serial = request.closure.serial;
  answer.closure.keyframe = request.closure.keyframe.id;
  answer.closure.reason = answer.search.reason;
  if (answer.search.verdict != PlaceVerdict::kFound || answer.search.contradiction > kSoundContradiction)
    return answer;

  ClosureRequest closure = request.closure;
  const Pose expected = renormalised(answer.search.map_from_predicted * closure.keyframe.map_from_body);
  const auto reach = static_cast<double>(closure.keyframe.reach);
  closure.earlier = nearest_to(expected.translation(), reach, request.search.places);
  if (closure.earlier.empty()) return answer;
  const ArchivedKeyframe& nearest = closure.earlier.front();
  const std::optional<std::size_t> other = submap_of(nearest.id, request.others);
  if (!other) return answer;
  answer.other = *other;
  const Submap& submap = request.others[answer.other];
  const bool is_node = submap.graph.contains(nearest.id);
  answer.closure.nearest_keyframe = nearest.id;
  answer.closure.nearest = closure.nearest = is_node ? nearest.id : kOriginNode;
  closure.own_from_nearest = is_node ? nearest.map_from_body : submap.own_from_map;
  const std::optional<Constraint> found =
      find_closure(closure, expected, resolution(request.search, reach), config, &answer.closure.reason);
  if (!found) return answer;
  // In a tunnel every place along it fits, and agrees with every other.
  if (unknown_axes(inverse(found->information), ~0U) != 0) {
    answer.closure.reason.insert(0, "leaves a motion open: ");
    return answer;
  }
  answer.closure.closure = *found;
  answer.closure.outcome = ClosureOutcome::kPending;

  const auto place = [&](std::uint32_t keyframe) -> Eigen::Vector3d {
    return request.active.graph.nodes().at(keyframe).translation();
  };
  for (const JoinFind& find : request.finds) {
    const Constraint& earlier = find.closure;
    const bool there = submap.graph.contains(earlier.from) && request.active.graph.contains(earlier.to) &&
                       submap_of(find.nearest_keyframe, request.others) == other;
    if (!there || (place(earlier.to) - place(found->to)).norm() < kSameSpot * reach) continue;
    if (agree(submap.graph, request.active.graph, earlier, *found)) answer.agreeing.push_back(earlier);
  }
  if (answer.agreeing.size() < static_cast<std::size_t>(closure.planar ? kPlanarAgreeing : kAgreeing))
    return answer;
  answer.closure.outcome = ClosureOutcome::kAccepted;
  PoseGraph graph = joined(request.active, submap, *found);
  for (const Constraint& c : answer.agreeing) graph.connect(c);
  graph.connect(*found);
  graph.optimise();
  answer.closure.map_from_node = graph.nodes();
  answer.closure.covariance = graph.covariance(found->from, found->to);
  answer.closure.drift = graph.covariance(kOriginNode, found->to);
  return answer;
}

}  // namespace scanlock
