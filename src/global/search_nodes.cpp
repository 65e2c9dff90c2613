// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/search_nodes.hpp"

#include <algorithm>
#include <utility>

namespace scanlock {

void SearchNodes::push(Node node) {
  if (free_.empty()) {
    free_.push_back(static_cast<std::uint32_t>(nodes_.size()));
    nodes_.emplace_back();
  }
  const std::uint32_t index = free_.back();
  free_.pop_back();
  entries_ += node.matches.size();
  heap_.push_back({node.bound, serial_++, index});
  std::push_heap(heap_.begin(), heap_.end());
  nodes_[index] = std::move(node);
}

Node SearchNodes::pop() {
  std::pop_heap(heap_.begin(), heap_.end());
  const std::uint32_t index = heap_.back().node;
  heap_.pop_back();
  free_.push_back(index);
  Node node = std::move(nodes_[index]);
  entries_ -= node.matches.size();
  return node;
}

}  // namespace scanlock
