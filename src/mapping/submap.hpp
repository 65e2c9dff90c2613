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

/// Keyframes that are tied to each other, in a frame of their own.
struct Submap {
  PoseGraph graph;                       ///< kOriginNode is its frame
  Pose own_from_map = Pose::Identity();  ///< own: the frame of the tracker and its archive
  bool fixed = false;                    ///< a map that was given: kOriginNode is all that is a node of it
  bool located = true;  ///< false: begun by a robot that was not found in the map it was given
};

/// Whether the frame of `a` is that of both, once they are joined: that of the map which was given, or which
/// has the older keyframe.
bool is_older(const Submap& a, const Submap& b);

/// Both as one graph, in the frame of the older one; `closure`, from the other one to the active one, says
/// how they lie to each other and is still to be connected.
PoseGraph joined(const Submap& active, const Submap& other, const Constraint& closure);

/// The submap of a keyframe, by its place; none where it is none of them. What is a node of none is of a
/// fixed one.
std::optional<std::size_t> submap_of(std::uint32_t keyframe, const std::vector<Submap>& submaps);

/// What a file keeps: each keyframe in the frame of its submap. Constraints name keyframes by their ids, the
/// file by their places; the oldest submap alone is tied to the frame of the file, and others that have but
/// one keyframe are not kept. `map`: all keyframes, in the frame of the active submap.
SavedMap saved_map(const SavedMap& map, const Submap& active, const std::vector<Submap>& others);
/// The submaps of such a file, the one that is tied to its frame first. Single keyframes that nothing ties
/// are taken for part of that.
std::vector<Submap> submaps_of(const SavedMap& saved);

/// The keyframes alone that are tied to the frame of the file.
SavedMap first_submap(SavedMap saved);

}  // namespace scanlock
