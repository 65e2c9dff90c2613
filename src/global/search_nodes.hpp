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

/// A set of poses that a search over matches has not decided about: a slab of heights, a sector of angles in
/// it, or a box.
struct Node {
  int bound = 0;
  NodeKind kind = NodeKind::kSlab;
  PoseBox box;       // a slab has z, a sector also theta
  double cell = 0;   // of a sector
  double lever = 0;  // of a box
  // Of a box: when conflicts were looked for, last.
  int tried_drops = std::numeric_limits<int>::max(), iterations = 0;
  double tried_size = std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> matches;
};

/// The nodes that are open, and the memory they take.
class SearchNodes {
 public:
  bool empty() const { return heap_.empty(); }
  int highest_bound() const { return heap_.front().bound; }
  std::size_t entries() const { return entries_; }  ///< match indices in all nodes
  void push(Node node);
  /// The highest bound first, then the newest, for it is the smallest.
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
