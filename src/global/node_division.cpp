// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Division and bounds of the nodes of a pose search: slabs, sectors, boxes.
#include <algorithm>
#include <cmath>

#include "global/pose_search.hpp"

namespace scanlock {
namespace {

constexpr int kMostPieces = 8;
constexpr double kSlabHeight = 6;  // thresholds

}  // namespace

void PoseSearch::measure() {
  double p = 0, q = 0;
  for (std::size_t i = 0; i < m_.size(); ++i) {
    p += m_.px[i] * m_.px[i] + m_.py[i] * m_.py[i];
    q += m_.qx[i] * m_.qx[i] + m_.qy[i] * m_.qy[i];
  }
  const auto n = static_cast<double>(m_.size());
  lever_ = std::sqrt(p / n);
  spread_ = 2 * (lever_ + std::sqrt(q / n));
}

/// Opens slabs over all heights at which a pose can hold any match.
void PoseSearch::open_slabs() {
  const double height = kSlabHeight * m_.largest_threshold;
  const double outside = m_.largest_threshold * (1 + kRelativeTolerance) + 2 * m_.rounding;
  const double half = 0.5 * height * (1 + 1e-6) + 2 * m_.rounding;  // overlapping
  for (double z = m_.dz.front() - outside; z <= m_.dz.back() + outside;) {
    Node slab;
    slab.box.centre.z = z + 0.5 * height;
    slab.box.half_z = half;
    const double bottom = slab.box.centre.z - half - outside, top = slab.box.centre.z + half + outside;
    const auto [first, last] = height_range(m_, bottom, top);
    if (first == last) {  // jump over heights without matches
      if (first == m_.size()) break;
      z = std::max(z + height, m_.dz[first] - outside);
      continue;
    }
    slab.bound = static_cast<int>(last - first);
    open_.push(std::move(slab));
    z += height;
  }
}

void PoseSearch::push_sector(const PoseBox& slab, double theta, double half_theta, double cell) {
  Node node;
  node.kind = NodeKind::kSector;
  node.box = slab;
  node.box.centre.theta = theta;
  node.box.half_theta = half_theta;
  node.cell = cell;
  node.bound = voting_.vote({slab.centre.z, slab.half_z, theta, half_theta, cell});
  if (node.bound < wanted()) return;
  voting_.open_matches(wanted(), node.matches);
  voting_.heights(wanted(), node.box.centre.z, node.box.half_z);
  open_.push(std::move(node));
}

/// Number of sectors into which to divide a sector with `matches` matches and cells of `cell` metres: as few
/// as possible, but enough that their votes can exclude parts without a better pose than the incumbent. A
/// sector of half the angle has cells of half the side, and a quarter of the votes in each.
int PoseSearch::pieces(double cell, std::size_t matches) const {
  constexpr double kCrowding = 20;  // votes of a match, times the fullest cell over the mean
  int count = 2;
  for (; count < kMostPieces; count *= 2) {
    const double side = cell / count;
    if (kCrowding * static_cast<double>(matches) * side * side <= wanted() * spread_ * spread_) break;
  }
  return count;
}

void PoseSearch::divide_slab(const Node& node) {
  const std::size_t n = voting_.load_slab(node.box.centre.z, node.box.half_z);
  // With very many matches, wide sectors would give no useful bounds. But while the incumbent has no more
  // than the consensus of a chance pose, wide sectors are used, because they lead to a better pose.
  constexpr int kChance = 12;
  const bool fine = answer_.consensus() > kChance && pieces(slab_cell(), n) == kMostPieces;
  const int sectors = kSlabSectors * (fine ? kMostPieces : 1);
  const double half = kPi / sectors, cell = slab_cell() * kSlabSectors / sectors;
  result_.work += n * static_cast<std::size_t>(sectors);
  for (int k = 0; k < sectors; ++k)
    push_sector(node.box, (2 * k + 1) * half, half * (1 + 1e-12), std::max(cell, voting_.smallest_cell()));
}

void PoseSearch::divide_sector(const Node& node) {
  constexpr std::size_t kFew = 96;  // matches: up to so many are processed faster in boxes
  constexpr std::size_t kDescents = 2;
  const std::size_t n = voting_.load(node.matches, node.box.centre.z, node.box.half_z);
  const Sector sector{node.box.centre.z, node.box.half_z, node.box.centre.theta, node.box.half_theta,
                      node.cell};
  const bool descending = node.bound > answer_.consensus() && descents_ < kDescents;
  const bool gathering = node.cell <= voting_.smallest_cell() || n <= kFew;
  if (descending || gathering) {
    voting_.vote(sector);
    result_.work += n;
  }
  if (descending) {
    descend(sector, node.bound);
    if (node.bound < wanted()) return;
  }
  if (gathering && voting_.gather(sector, wanted(), cells_)) {
    for (VotedCell& cell : cells_) {
      if (answer_.all_kept(cell.matches)) continue;
      Node origin;
      origin.bound = static_cast<int>(cell.matches.size());
      push_box(cell.box, cell.matches, origin);
    }
    return;
  }
  const int sectors = pieces(node.cell, n);
  const double half = node.box.half_theta / sectors;
  result_.work += n * static_cast<std::size_t>(sectors);
  for (int k = 0; k < sectors; ++k) {
    push_sector(node.box, node.box.centre.theta + (2 * k + 1 - sectors) * half, half * (1 + 1e-12),
                std::max(node.cell / sectors, voting_.smallest_cell()));
  }
}

/// False if the box is too small to be divided further.
bool PoseSearch::matters(const PoseBox& box, double lever) const {
  return longest_side(box, lever) > (pruning_ ? 0.5 * m_.largest_threshold : m_.rounding);
}

/// Tries to prove that no pose at all, in the box or outside, holds enough of the box's matches. Without this
/// proof the search would have to divide down to boxes as small as the margin by which one more match is
/// missed. Also ends boxes whose matches have a single common pose. Tried again when fewer matches may be
/// left out, and with more iterations when the box has shrunk.
void PoseSearch::look_for_conflicts(Node& node) {
  constexpr int kFewDrops = 2, kIterations = 16, kMostIterations = 2048;
  constexpr double kShrunk = 0.125;
  constexpr std::size_t kFew = 12;                                     // matches: the proof costs little
  const double first_size = node.matches.size() <= kFew ? 0.5 : 0.01;  // in thresholds
  const int drops = static_cast<int>(node.matches.size()) - wanted();
  const double size = longest_side(node.box, node.lever) / m_.largest_threshold;
  const bool shrunk = size <= kShrunk * node.tried_size;
  if (size > first_size || drops > kFewDrops || (drops >= node.tried_drops && !shrunk)) return;
  node.iterations =
      std::min(kMostIterations, shrunk && node.tried_size < first_size ? 4 * node.iterations : kIterations);
  node.tried_drops = drops;
  node.tried_size = size;
  Incumbent found = answer_.best();
  const bool infeasible = conflicts_.infeasible(node.matches, drops, node.iterations, found);
  result_.work += node.matches.size() * static_cast<std::size_t>(node.iterations);
  if (infeasible) node.bound = std::min(node.bound, wanted() - 1);
  if (found.consensus > answer_.consensus()) offer(found.pose, found.consensus, node.matches);
}

/// Opens a box in which matches of another node, `origin`, may be held.
void PoseSearch::push_box(const PoseBox& box, const std::vector<std::uint32_t>& matches, const Node& origin) {
  if (excluded_ && excluded_->holds(box)) return;
  const BoxCounts counts = filter_.filter(box, matches, scratch_[0]);  // 2: 5, 7
  result_.work += matches.size();
  Node node;
  node.box = box;
  const bool possible = counts.possible >= wanted() && filter_.contract(wanted(), node.box);
  if (counts.at_centre > answer_.consensus()) offer(box.centre, counts.at_centre, scratch_[0]);  // 2: 6
  node.bound = std::min(counts.possible, origin.bound);
  if (!possible || node.bound < wanted() || answer_.all_kept(scratch_[0])) return;
  node.kind = NodeKind::kBox;
  node.lever = counts.lever;
  node.tried_drops = origin.tried_drops;
  node.tried_size = origin.tried_size;
  node.iterations = origin.iterations;
  node.matches = scratch_[0];
  open_.push(std::move(node));
}

void PoseSearch::divide_box(Node& node) {
  PoseBox halves[2];
  look_for_conflicts(node);
  if (node.bound < wanted()) return;
  if (!matters(node.box, node.lever)) {
    if (pruning_) {
      answer_.keep(node.matches);
    } else {
      result_.upper_bound = std::max(result_.upper_bound, node.bound);  // smaller than rounding
    }
    return;
  }
  halve(node.box, node.lever, halves);
  for (const PoseBox& half : halves) push_box(half, node.matches, node);
}

}  // namespace scanlock
