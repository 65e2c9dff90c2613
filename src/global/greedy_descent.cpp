// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Greedy descent: finds poses for a pose search in the fullest sectors, cells and boxes, without a proof.
#include <algorithm>

#include "global/pose_search.hpp"

namespace scanlock {

/// Finds a first pose, without which no node can be pruned: descends into the fullest sectors of the fullest
/// slab.
void PoseSearch::seed() {
  const Node slab = open_.pop();
  std::size_t n = voting_.load_slab(slab.box.centre.z, slab.box.half_z);
  Sector fullest{slab.box.centre.z, slab.box.half_z, kPi, kPi, kSlabSectors * slab_cell()};
  constexpr double kFine = 4;
  std::vector<std::uint32_t> matches;
  while (n > 0) {
    Sector sector = fullest;
    sector.half_theta = fullest.half_theta / kSlabSectors;
    sector.cell = std::max(fullest.cell / kSlabSectors, voting_.smallest_cell());
    int most = 0;
    for (int k = 0; k < kSlabSectors; ++k) {
      Sector part = sector;
      part.theta = fullest.theta + (2 * k + 1 - kSlabSectors) * sector.half_theta;
      const int bound = voting_.vote(part);
      if (bound <= most) continue;
      most = bound;
      sector.theta = part.theta;
    }
    result_.work += n * static_cast<std::size_t>(kSlabSectors);
    voting_.vote(sector);
    if (sector.cell <= kFine * voting_.smallest_cell()) {
      descend(sector, most);
      break;
    }
    voting_.open_matches(most, matches);
    n = voting_.load(matches, sector.z, sector.half_z);
    fullest = sector;
  }
  open_.push(slab);
}

void PoseSearch::descend(const Sector& sector, int bound) {
  ++descents_;
  voting_.gather(sector, bound, cells_);
  if (!cells_.empty()) {
    descend(*std::max_element(cells_.begin(), cells_.end(), [](const VotedCell& a, const VotedCell& b) {
      return a.matches.size() < b.matches.size();
    }));
  }
}

/// Halves the box of the cell repeatedly, going on with the fuller half, and offers the poses found.
void PoseSearch::descend(const VotedCell& cell) {
  PoseBox box = cell.box, halves[2];
  double lever = lever_;
  std::vector<std::uint32_t> matches = cell.matches;
  while (static_cast<int>(matches.size()) > answer_.consensus() && matters(box, lever) &&
         std::max(box.half_x, box.half_theta * lever) > 0.25 * m_.largest_threshold) {
    halve(box, lever, halves);
    BoxCounts counts[2];
    for (int k = 0; k < 2; ++k) {
      counts[k] = filter_.filter(halves[k], matches, scratch_[k]);
      if (counts[k].at_centre > answer_.consensus())
        offer(halves[k].centre, counts[k].at_centre, scratch_[k]);
    }
    result_.work += 2 * matches.size();
    const int fuller = counts[1].possible > counts[0].possible ? 1 : 0;
    box = halves[fuller];
    lever = counts[fuller].lever;
    matches.swap(scratch_[fuller]);
  }
  if (static_cast<int>(matches.size()) <= answer_.consensus()) return;
  offer(fit(m_, matches), 0, matches);
}

void PoseSearch::offer(const LevelPose& pose, int count, const std::vector<std::uint32_t>& held) {
  constexpr std::size_t kClimb = 16;  // times that a climb visits a match
  result_.work += kClimb * held.size();
  if (answer_.offer(pose, count, held)) descents_ = 0;
}

}  // namespace scanlock
