// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "global/bounds/pose_box.hpp"

namespace scanlock {

enum class NodeKind { kSlab, kSector, kBox };

/// A set of poses that a search over matches has neither excluded nor divided yet: a slab of heights, a
/// sector of angles in a slab, or a box.
struct Node {
  int bound = 0;  // no pose of the node holds more matches
  NodeKind kind = NodeKind::kSlab;
  PoseBox box;       // a slab uses z only, a sector also theta
  double cell = 0;   // metres, of a sector
  double lever = 0;  // metres, of a box, see BoxCounts
  // Of a box: the state at the last search for conflicts.
  int tried_drops = std::numeric_limits<int>::max(), iterations = 0;
  double tried_size = std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> matches;
};

/// The open nodes, and the memory that they take.
class SearchNodes {
 public:
  bool empty() const { return heap_.empty(); }
  int highest_bound() const { return heap_.front().bound; }
  std::size_t entries() const { return entries_; }  ///< match indices in all nodes
  void push(Node node);
  /// Removes and returns the node of highest bound; of equal bounds the newest node, which is the smallest.
  Node pop();

 private:
  struct Open {
    int bound;
    std::size_t serial;
    std::uint32_t node;
    bool operator<(const Open& other) const {
      return bound != other.bound ? bound < other.bound : serial < other.serial;
    }
  };

  std::vector<Open> heap_;
  std::vector<Node> nodes_;  // open or free
  std::vector<std::uint32_t> free_;
  std::size_t serial_ = 0, entries_ = 0;
};

}  // namespace scanlock
