// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/submap.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace scanlock {
namespace {

std::uint32_t first_keyframe(const Submap& submap) {
  const auto first = submap.graph.nodes().upper_bound(kOriginNode);
  return first == submap.graph.nodes().end() ? kOriginNode : first->first;
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
    const std::size_t submap = submap_of(k.id, submaps).value_or(0);
    // The nodes are the submap's frame and this keyframe.
    if (submap > 0 && submaps[submap].graph.nodes().size() == 2) continue;
    SavedMap one;
    one.keyframes.push_back(k);
    if (const auto other = submap_of(k.id, others))
      one = moved(one, others[*other].own_from_map.inverse() * active.own_from_map);
    saved.keyframes.push_back(std::move(one.keyframes.front()));
    places.emplace(k.id, static_cast<std::uint32_t>(places.size()));
  }
  for (std::size_t i = 0; i < submaps.size(); ++i) {
    if (i > 0) submaps[i].graph.remove(kOriginNode);
    for (Constraint c : submaps[i].graph.constraints()) {
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
  for (const Constraint& c : saved.constraints) graph.connect_new(c);
  std::vector<Submap> submaps;
  for (PoseGraph& part : graph.parts()) {
    const auto [first, pose] = *part.nodes().begin();
    Constraint constraint;
    constraint.to = first;
    constraint.from_to = pose;
    constraint.information = Matrix6::Identity() / (kPoseFloor * kPoseFloor);
    const bool is_single = part.nodes().size() == 1 && first != kOriginNode;
    if (!is_single) submaps.emplace_back().graph = std::move(part);
    PoseGraph& of_constraint = is_single ? submaps.front().graph : submaps.back().graph;
    if (first == kOriginNode) continue;
    of_constraint.add(kOriginNode, Pose::Identity());
    of_constraint.add(first, pose);
    of_constraint.connect_new(constraint);
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

}  // namespace scanlock
