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

/// Keyframes that constraints connect, in a frame of their own.
struct Submap {
  PoseGraph graph;                       ///< kOriginNode is its frame
  Pose own_from_map = Pose::Identity();  ///< own: the frame of the tracker and its archive
  bool fixed = false;  ///< true: holds a map that was given and does not move; kOriginNode stands for all its
                       ///< keyframes
  /// False: its frame is not that of the map it was loaded with, or which its robot was not found in.
  bool located = true;
};

/// Whether the joined submap takes the frame of `a`: the frame of a map that was given, else that of the
/// older keyframe.
bool is_older(const Submap& a, const Submap& b);

/// Both as one graph, in the frame of the older one. `closure`, a constraint from the other to the active
/// submap, gives their relative pose, and is not connected yet.
PoseGraph joined(const Submap& active, const Submap& other, const Constraint& closure);

/// The index of the submap that a keyframe is of; nothing where it is of none of them. A keyframe that is no
/// node is of the fixed one.
std::optional<std::size_t> submap_of(std::uint32_t keyframe, const std::vector<Submap>& submaps);

/// The content of a map file: each keyframe in the frame of its submap. Constraints name keyframes by their
/// ids, the file by their places; the oldest submap alone is tied to the frame of the file, and others that
/// have but one keyframe are not kept. `map`: all keyframes, in the frame of the active submap.
SavedMap saved_map(const SavedMap& map, const Submap& active, const std::vector<Submap>& others);
/// The submaps of a map file, that which is tied to the file's frame first. Single keyframes without a
/// constraint are taken as part of it.
std::vector<Submap> submaps_of(const SavedMap& saved);

/// Only the keyframes that are tied to the file's frame.
SavedMap first_submap(SavedMap saved);

}  // namespace scanlock
