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
  bool joined = false;  ///< false: no overlap was accepted, and `map` is empty
  SavedMap map;         ///< keyframes of the first map, then of the second, in the frame of the first
  /// Keyframes of the second map that were searched for, and found, in the first.
  std::size_t searches = 0, found = 0;
  /// The largest number of found keyframes that agree on one relative pose.
  std::size_t agreeing = 0;
  std::size_t otherwise = 0;  ///< of the other found keyframes, the largest number that agree on another one
  std::size_t closures = 0;   ///< constraints between the two maps in the optimised graph
};

/// Found keyframes that have to agree on the relative pose of the maps.
inline constexpr std::size_t kAgreeingSearches = 3;

/// Joins two overlapping maps of unrelated frames. Keyframes from all over the second map are searched for in
/// the first as join_submaps() does. The maps are joined where at least kAgreeingSearches found keyframes
/// agree on the relative pose and no two of the other ones agree on another; then loop closures are added
/// along the overlap, accepted by the rules of close_loop(), and the graph is optimised. Keyframes that no
/// constraints connect to the frame of their map are left out. z is up in both maps. Deterministic.
/// `progress`: keyframes done and in total.
MapMerge merge_maps(const SavedMap& first, const SavedMap& second, const TrackerConfig& config,
                    const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

}  // namespace scanlock
