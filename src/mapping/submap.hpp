// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "mapping/loop_closure.hpp"
#include "mapping/pose_graph.hpp"
#include "odometry/keyframe_archive.hpp"

namespace scanlock {

/// A set of keyframes that constraints connect, with its own frame.
struct Submap {
  PoseGraph graph;                       ///< kOriginNode is the submap's frame
  Pose own_from_map = Pose::Identity();  ///< own: the frame of the tracker and its archive
  /// True: holds a given map, which does not move; kOriginNode stands for all keyframes of that map.
  bool fixed = false;
  /// False: a map was loaded, and the submap's pose in the frame of that map is not known.
  bool located = true;
};

/// Whether the joined submap takes the frame of `a`: the frame of a map that was given, else that of the
/// older keyframe.
bool is_older(const Submap& a, const Submap& b);

/// Both as one graph, in the frame of the older one. `closure`, a constraint from the other to the active
/// submap, gives their relative pose; it is not added to the graph.
PoseGraph joined(const Submap& active, const Submap& other, const Constraint& closure);

/// The index of the submap that a keyframe belongs to; nothing where it belongs to none of them. A keyframe
/// that is no node of any graph belongs to the fixed submap.
std::optional<std::size_t> submap_of(std::uint32_t keyframe, const std::vector<Submap>& submaps);

/// The content of a map file: each keyframe in the frame of its submap. Constraints name keyframes by their
/// ids, in the file by their places in the list. Only the oldest submap is connected to the frame of the
/// file; other submaps with a single keyframe are left out. `map`: all keyframes, in the frame of the active
/// submap.
SavedMap saved_map(const SavedMap& map, const Submap& active, const std::vector<Submap>& others);
/// The submaps of a map file; that which is connected to the file's frame comes first, and contains single
/// keyframes without a constraint, too.
std::vector<Submap> submaps_of(const SavedMap& saved);

/// The map with only the keyframes that constraints connect to the file's frame.
SavedMap first_submap(SavedMap saved);

}  // namespace scanlock
