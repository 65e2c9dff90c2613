// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/pose_search.hpp"

#include <algorithm>
#include <cmath>

#include "global/sector_voting.hpp"

namespace scanlock {
namespace {

constexpr double kPi = 3.14159265358979323846;

enum class NodeKind { kSlab, kSector, kBox };

struct Node {
  int bound = 0;
  std::size_t serial = 0;
  NodeKind kind = NodeKind::kSlab;
  PoseBox box;       // a slab has z, a sector also theta
  double cell = 0;   // of a sector
  double lever = 0;  // of a box
  int tried = 0;     // of a box: how hard a pose for all its matches was looked for
  std::vector<std::uint32_t> matches;

  /// The highest bound first, then the newest, for it is the smallest.
  bool operator<(const Node& other) const {
    return bound != other.bound ? bound < other.bound : serial < other.serial;
  }
};

/// Half of it; angles are measured by what they move.
double longest_side(const PoseBox& box, double lever) {
  return std::max({box.half_x, box.half_y, box.half_z, box.half_theta * lever});
}

class Search {
 public:
  Search(const LevelMatches& matches, Incumbent& best, const SearchLimits& limits,
         const std::optional<ExcludedPoses>& excluded, bool pruning)
      : m_(matches),
        best_(best),
        limits_(limits),
        excluded_(excluded),
        pruning_(pruning),
        filter_(matches),
        voting_(matches) {}

  SearchResult run();
  std::vector<std::uint32_t> kept();

 private:
  /// The least bound that still matters.
  int wanted() const { return std::max(1, best_.consensus + (pruning_ ? 0 : 1)); }
  double lever_of_all() const;
  void push(Node node);
  void open_slabs();
  void divide_slab(const Node& node);
  void push_sector(const PoseBox& slab, double theta, double half_theta, double cell);
  void divide_sector(const Node& node);
  void divide_box(Node& node);
  void try_all_of(Node& node);
  bool divide(const PoseBox& box, double lever, PoseBox halves[2]) const;
  void dive(const VotedCell& cell);
  void offer(const LevelPose& pose, int consensus, const std::vector<std::uint32_t>& held);
  void keep(const std::vector<std::uint32_t>& matches);
  bool all_kept(const std::vector<std::uint32_t>& matches) const;
  bool out_of_budget() const;

  const LevelMatches& m_;
  Incumbent& best_;
  const SearchLimits& limits_;
  const std::optional<ExcludedPoses>& excluded_;
  const bool pruning_;
  BoxFilter filter_;
  SectorVoting voting_;
  std::vector<Node> heap_;
  std::vector<std::uint8_t> kept_;
  std::vector<std::uint32_t> scratch_[2];
  std::vector<VotedCell> cells_;
  SearchResult result_;
  std::size_t serial_ = 0, entries_ = 0, dives_ = 0;
  double lever_ = 0, slab_z_ = 0, slab_half_ = -1;
};

double Search::lever_of_all() const {
  double sum = 0;
  for (std::size_t i = 0; i < m_.size(); ++i) sum += m_.px[i] * m_.px[i] + m_.py[i] * m_.py[i];
  return std::sqrt(sum / static_cast<double>(m_.size()));
}

void Search::push(Node node) {
  node.serial = serial_++;
  entries_ += node.matches.size();
  heap_.push_back(std::move(node));
  std::push_heap(heap_.begin(), heap_.end());
}

/// Slabs over all heights that a pose of some consensus can have.
void Search::open_slabs() {
  const double height = 2 * m_.largest_threshold;
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
    push(std::move(slab));
    z += height;
  }
}

void Search::push_sector(const PoseBox& slab, double theta, double half_theta, double cell) {
  Node node;
  node.kind = NodeKind::kSector;
  node.box = slab;
  node.box.centre.theta = theta;
  node.box.half_theta = half_theta;
  node.cell = cell;
  node.bound = voting_.vote({slab.centre.z, slab.half_z, theta, half_theta, cell});
  if (node.bound >= wanted()) push(std::move(node));
}

void Search::divide_slab(const Node& node) {
  constexpr int kSectors = 8;
  const std::size_t n = voting_.set_slab(node.box.centre.z, node.box.half_z);
  result_.work += n * kSectors;
  const double half = kPi / kSectors;
  for (int k = 0; k < kSectors; ++k) {
    push_sector(node.box, (2 * k + 1) * half, half * (1 + 1e-12),
                std::max(2 * half * lever_, voting_.smallest_cell()));
  }
}

void Search::divide_sector(const Node& node) {
  constexpr std::size_t kCrowd =
      2;  // votes in open cells, per match, above which smaller sectors are cheaper
  constexpr std::size_t kDives = 64;
  const std::size_t n = voting_.set_slab(node.box.centre.z, node.box.half_z);
  const Sector sector{node.box.centre.z, node.box.half_z, node.box.centre.theta, node.box.half_theta,
                      node.cell};
  voting_.vote(sector);
  result_.work += n;
  if (node.bound > best_.consensus && dives_ < kDives) {
    ++dives_;
    voting_.gather(sector, node.bound, cells_);
    if (!cells_.empty()) {
      dive(*std::max_element(cells_.begin(), cells_.end(), [](const VotedCell& a, const VotedCell& b) {
        return a.matches.size() < b.matches.size();
      }));
    }
    if (node.bound < wanted()) return;
  }
  const bool smallest = node.cell <= voting_.smallest_cell();
  if ((smallest || voting_.members(wanted()) <= kCrowd * n) && voting_.gather(sector, wanted(), cells_)) {
    for (VotedCell& cell : cells_) {
      if (pruning_ && all_kept(cell.matches)) continue;
      Node box;
      box.kind = NodeKind::kBox;
      box.box = cell.box;
      box.bound = static_cast<int>(cell.matches.size());
      box.lever = lever_;
      box.matches = std::move(cell.matches);
      push(std::move(box));
    }
    return;
  }
  const double half = 0.5 * node.box.half_theta;
  result_.work += 2 * n;
  for (const double side : {-half, half}) {
    push_sector(node.box, node.box.centre.theta + side, half * (1 + 1e-12),
                std::max(0.5 * node.cell, voting_.smallest_cell()));
  }
}

/// Halves the longest side. False when the box is too small to matter.
bool Search::divide(const PoseBox& box, double lever, PoseBox halves[2]) const {
  const double turn = box.half_theta * lever, longest = longest_side(box, lever);
  if (longest <= (pruning_ ? 0.25 * m_.largest_threshold : m_.rounding)) return false;
  halves[0] = halves[1] = box;
  const auto split = [&](double LevelPose::*centre, double PoseBox::*half) {
    const double quarter = 0.5 * (box.*half);
    for (int k = 0; k < 2; ++k) {
      halves[k].centre.*centre += k == 0 ? -quarter : quarter;
      halves[k].*half = quarter * (1 + 1e-12);
    }
  };
  if (longest == turn) {
    split(&LevelPose::theta, &PoseBox::half_theta);
  } else if (longest == box.half_x) {
    split(&LevelPose::x, &PoseBox::half_x);
  } else if (longest == box.half_y) {
    split(&LevelPose::y, &PoseBox::half_y);
  } else {
    split(&LevelPose::z, &PoseBox::half_z);
  }
  return true;
}

/// Small boxes whose matches have a common pose end here, also when that is a single point that no centre
/// ever hits.
void Search::try_all_of(Node& node) {
  const double size = longest_side(node.box, node.lever);
  if (node.tried < 1 && size <= 0.25 * m_.largest_threshold) {
    node.tried = 1;
    offer(node.box.centre, 0, node.matches);
  }
  constexpr double kSizes[] = {0.01, 0.0005};
  constexpr int kIterations[] = {60, 2000};
  for (int k = 0; k < 2; ++k) {
    if (node.tried > k + 1 || size > kSizes[k] * m_.largest_threshold || node.bound < wanted()) continue;
    node.tried = k + 2;
    Incumbent squeezed = best_;
    squeeze(m_, node.matches, kIterations[k], squeezed);
    offer(squeezed.pose, squeezed.consensus, node.matches);
  }
}

void Search::divide_box(Node& node) {
  PoseBox halves[2];
  try_all_of(node);
  if (node.bound < wanted()) return;
  if (!divide(node.box, node.lever, halves)) {
    if (pruning_) {
      keep(node.matches);
    } else {
      result_.upper_bound = std::max(result_.upper_bound, node.bound);  // cannot be told apart by rounding
    }
    return;
  }
  for (const PoseBox& half : halves) {
    if (excluded_ && excluded_->holds(half)) continue;
    const BoxCounts counts = filter_.filter(half, node.matches, scratch_[0]);
    result_.work += node.matches.size();
    if (counts.at_centre > best_.consensus) offer(half.centre, counts.at_centre, scratch_[0]);
    if (counts.possible < wanted() || (pruning_ && all_kept(scratch_[0]))) continue;
    Node child;
    child.kind = NodeKind::kBox;
    child.bound = counts.possible;
    child.box = half;
    child.lever = counts.lever;
    child.tried = node.tried;
    child.matches = scratch_[0];
    push(std::move(child));
  }
}

/// Goes down the fuller halves.
void Search::dive(const VotedCell& cell) {
  PoseBox box = cell.box, halves[2];
  double lever = lever_;
  std::vector<std::uint32_t> matches = cell.matches;
  while (static_cast<int>(matches.size()) > best_.consensus && divide(box, lever, halves) &&
         std::max(box.half_x, box.half_theta * lever) > 0.25 * m_.largest_threshold) {
    BoxCounts counts[2];
    for (int k = 0; k < 2; ++k) {
      counts[k] = filter_.filter(halves[k], matches, scratch_[k]);
      if (counts[k].at_centre > best_.consensus) offer(halves[k].centre, counts[k].at_centre, scratch_[k]);
    }
    result_.work += 2 * matches.size();
    const int fuller = counts[1].possible > counts[0].possible ? 1 : 0;
    box = halves[fuller];
    lever = counts[fuller].lever;
    matches.swap(scratch_[fuller]);
  }
  if (static_cast<int>(matches.size()) <= best_.consensus) return;
  offer(fit(m_, matches), 0, matches);
}

void Search::offer(const LevelPose& pose, int count, const std::vector<std::uint32_t>& held) {
  const int before = best_.consensus;
  if (count > best_.consensus && !(excluded_ && excluded_->holds(pose))) best_ = {pose, count};
  Incumbent climbed = best_;
  climb(m_, held, climbed);
  if (climbed.consensus > best_.consensus && !(excluded_ && excluded_->holds(climbed.pose))) best_ = climbed;
  if (best_.consensus == before) return;
  dives_ = 0;
  if (pruning_) keep(inliers(m_, best_.pose));
}

void Search::keep(const std::vector<std::uint32_t>& matches) {
  for (const std::uint32_t i : matches) kept_[i] = 1;
}

bool Search::all_kept(const std::vector<std::uint32_t>& matches) const {
  return std::all_of(matches.begin(), matches.end(), [&](std::uint32_t i) { return kept_[i] != 0; });
}

bool Search::out_of_budget() const {
  return result_.nodes >= limits_.nodes || result_.work >= limits_.work || entries_ > limits_.list_entries ||
         std::chrono::steady_clock::now() > limits_.deadline;
}

SearchResult Search::run() {
  if (m_.size() > 0) {
    kept_.assign(m_.size(), 0);
    if (pruning_) keep(inliers(m_, best_.pose));
    lever_ = lever_of_all();
    open_slabs();
  }
  while (!heap_.empty() && heap_.front().bound >= wanted()) {
    if (out_of_budget()) {
      result_.upper_bound = std::max({result_.upper_bound, heap_.front().bound, best_.consensus});
      return result_;
    }
    std::pop_heap(heap_.begin(), heap_.end());
    Node node = std::move(heap_.back());
    heap_.pop_back();
    entries_ -= node.matches.size();
    ++result_.nodes;
    switch (node.kind) {
      case NodeKind::kSlab:
        divide_slab(node);
        break;
      case NodeKind::kSector:
        divide_sector(node);
        break;
      case NodeKind::kBox:
        divide_box(node);
        break;
    }
  }
  result_.finished = result_.upper_bound <= best_.consensus;
  result_.upper_bound = std::max(result_.upper_bound, best_.consensus);
  return result_;
}

std::vector<std::uint32_t> Search::kept() {
  std::vector<std::uint32_t> list;
  for (std::uint32_t i = 0; i < kept_.size(); ++i) {
    if (kept_[i]) list.push_back(i);
  }
  return list;
}

}  // namespace

bool ExcludedPoses::holds(const LevelPose& pose) const {
  PoseBox box;
  box.centre = pose;
  return holds(box);
}

bool ExcludedPoses::holds(const PoseBox& box) const {
  const double dx = std::abs(box.centre.x - centre.x) + box.half_x,
               dy = std::abs(box.centre.y - centre.y) + box.half_y,
               dz = std::abs(box.centre.z - centre.z) + box.half_z;
  return dx * dx + dy * dy + dz * dz <= distance * distance &&
         std::abs(std::remainder(box.centre.theta - centre.theta, 2 * kPi)) + box.half_theta <= angle;
}

SearchResult search_poses(const LevelMatches& matches, Incumbent& best, const SearchLimits& limits,
                          const std::optional<ExcludedPoses>& excluded) {
  return Search(matches, best, limits, excluded, false).run();
}

SearchResult prune_matches(const LevelMatches& matches, Incumbent& best, std::vector<std::uint32_t>& kept,
                           const SearchLimits& limits) {
  const std::optional<ExcludedPoses> none;
  Search search(matches, best, limits, none, true);
  const SearchResult result = search.run();
  kept.clear();
  if (result.finished) {
    kept = search.kept();
  } else {
    for (std::uint32_t i = 0; i < matches.size(); ++i) kept.push_back(i);
  }
  return result;
}

}  // namespace scanlock
