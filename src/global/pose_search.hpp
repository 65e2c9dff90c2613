// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/angles.hpp"
#include "global/bounds/box_filter.hpp"
#include "global/bounds/conflicts.hpp"
#include "global/bounds/sector_voting.hpp"
#include "global/branch_and_bound.hpp"
#include "global/search_answer.hpp"
#include "global/search_nodes.hpp"

namespace scanlock {

/// The search of branch_and_bound.hpp. Its loop is in branch_and_bound.cpp, the division and bounds of its
/// nodes in node_division.cpp, and the search for first poses in greedy_descent.cpp.
class PoseSearch {
 public:
  PoseSearch(const LevelMatches& matches, Incumbent& best, const SearchLimits& limits,
             const std::optional<ExcludedPoses>& excluded, bool pruning)
      : m_(matches),
        answer_(matches, best, excluded, pruning),
        limits_(limits),
        excluded_(excluded),
        pruning_(pruning),
        filter_(matches),
        conflicts_(matches),
        voting_(matches) {}

  SearchResult run();
  std::vector<std::uint32_t> kept() const { return answer_.kept(); }

 private:
  static constexpr int kSlabSectors = 8;
  int wanted() const { return answer_.wanted(); }
  bool out_of_budget() const;

  // node_division.cpp
  void measure();
  void open_slabs();
  int pieces(double cell, std::size_t matches) const;
  void divide_slab(const Node& node);
  void push_sector(const PoseBox& slab, double theta, double half_theta, double cell);
  void divide_sector(const Node& node);
  void divide_box(Node& node);
  void push_box(const PoseBox& box, const std::vector<std::uint32_t>& matches, const Node& origin);
  void look_for_conflicts(Node& node);
  bool matters(const PoseBox& box, double lever) const;
  double slab_cell() const { return std::max(2 * kPi / kSlabSectors * lever_, voting_.smallest_cell()); }

  // greedy_descent.cpp
  void seed();
  void descend(const Sector& sector, int bound);
  void descend(const VotedCell& cell);
  void offer(const LevelPose& pose, int consensus, const std::vector<std::uint32_t>& held);

  const LevelMatches& m_;
  SearchAnswer answer_;
  const SearchLimits& limits_;
  const std::optional<ExcludedPoses>& excluded_;
  const bool pruning_;
  BoxFilter filter_;
  Conflicts conflicts_;
  SectorVoting voting_;
  SearchNodes open_;
  std::vector<std::uint32_t> scratch_[2];
  std::vector<VotedCell> cells_;
  SearchResult result_;
  std::size_t descents_ = 0;
  double lever_ = 0, spread_ = 0;  // metres: rms distance of p from the axis, width of the translations
};

}  // namespace scanlock
