// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "odometry/keyframe_archive.hpp"
#include "odometry/tracker_config.hpp"

namespace scanlock {

struct MapMerge {
  bool joined = false;  ///< false: no overlap was accepted, and the map is empty
  SavedMap map;         ///< keyframes of the first map, then of the second, in the frame of the first
  std::size_t searches = 0, found = 0;  ///< keyframes of the second map looked for, and found, in the first
  std::size_t agreeing = 0;             ///< of the found ones, the most that agree on one overlap
  std::size_t otherwise = 0;  ///< of those that do not agree with it, the most that agree on another one
  std::size_t closures = 0;   ///< between the two maps, in the graph that was optimised
};

/// Searches that have to agree on an overlap.
inline constexpr std::size_t kAgreeingFinds = 3;

/// Two maps of unrelated frames, which overlap, as one. Keyframes from all over the second map are searched
/// for in the first as join_submaps() does. The maps are joined where at least kAgreeingFinds finds agree and
/// no two of the others agree on another overlap; then loop closures are added along the overlap, each
/// accepted as close_loop() does, and the graph is optimised. Keyframes that no constraints tie to the frame
/// of their map are left out. z is up in both maps. Deterministic. `progress`: keyframes done and in all.
MapMerge merge_maps(const SavedMap& first, const SavedMap& second, const TrackerConfig& config,
                    const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

}  // namespace scanlock
