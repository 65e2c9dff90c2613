// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "global/bounds/pose_box.hpp"
#include "global/bounds/vote_table.hpp"
#include "global/matches.hpp"

namespace scanlock {

/// Poses with z in a slab and theta in a sector, and any x and y; divided into square cells of (x, y).
struct Sector {
  double z = 0, half_z = 0;          ///< metres
  double theta = 0, half_theta = 0;  ///< radians, half_theta at most pi / 8
  double cell = 1;                   ///< metres
};

/// One cell of a sector, and the matches that its poses may hold.
struct VotedCell {
  PoseBox box;
  std::vector<std::uint32_t> matches;
};

/// Bounds whole sectors of poses at once: each match votes for every cell of horizontal translations at which
/// some angle and height of the sector hold it, so that the largest count of a cell is an upper bound of the
/// consensus in the sector. This costs some nanoseconds per match, without sorting or computing angles, and
/// does not depend on the number of matches in a cell. Heights are distinguished at no extra cost: a cell has
/// a separate count for each of a few layers of the slab (lanes). Cells share a small table, (i, j) modulo
/// its side: sharing only raises a count.
class SectorVoting {
 public:
  explicit SectorVoting(const LevelMatches& matches);

  /// The smallest cell that a sector may have, metres.
  double smallest_cell() const { return smallest_cell_; }

  /// Loads the matches that poses with z in [z - half_z, z + half_z] (metres) can hold; returns their number.
  std::size_t load_slab(double z, double half_z);
  /// load_slab() restricted to the given matches.
  std::size_t load(const std::vector<std::uint32_t>& matches, double z, double half_z);
  /// The upper bound of the consensus in a sector of the loaded slab.
  int vote(const Sector& sector);
  /// After vote(): the range of heights within the slab in which the bound is at least `at_least`.
  void heights(int at_least, double& z, double& half_z) const;
  /// After vote(): the matches that voted for a cell with a count of at least `at_least`.
  void open_matches(int at_least, std::vector<std::uint32_t>& matches);
  /// After vote(): the cells with at least `at_least` matches. False, and no cells, if `at_least` matches
  /// vote for a whole side of the table: the sector is too wide for their distance from the axis.
  bool gather(const Sector& sector, int at_least, std::vector<VotedCell>& cells);

 private:
  static constexpr int kSide = VoteTable<std::int16_t>::kSide, kMostLanes = VoteTable<std::int16_t>::kLanes;
  struct Entry {
    std::uint64_t cell;
    std::uint32_t match;
  };
  static constexpr std::uint32_t kNoBlock = VoteTable<std::int16_t>::kNoBlock,
                                 kMarkedBlock = VoteTable<std::int16_t>::kMarkedBlock;
  bool is_wide(std::size_t k) const { return i1_[k] - i0_[k] >= kSide || j1_[k] - j0_[k] >= kSide; }
  PoseBox cell_box(const Sector& sector, std::uint64_t cell) const;
  void find_cells(const Sector& sector);

  void resize(std::size_t n);
  void set_slab(double z, double half_z, std::size_t most);
  std::size_t load_one(std::size_t place, std::uint32_t match);
  template <typename Lane>
  int vote(VoteTable<Lane>& table);
  template <typename Visit>
  void for_each_block(std::size_t k, const Visit& visit) const;
  template <typename Lane>
  void open_matches(VoteTable<Lane>& table, int at_least, std::vector<std::uint32_t>& matches);
  template <typename Lane>
  void collect_entries(VoteTable<Lane>& table, int at_least);

  struct Narrow {
    float px, py, qx, qy;
    double dz, limit;
  };
  const LevelMatches& m_;
  std::vector<Narrow> narrow_;
  float offset_ = 0, margin_ = 0;
  double smallest_cell_ = 0;
  std::vector<std::uint32_t> matches_;            // the loaded matches, and for each of them:
  std::vector<float> px_, py_, qx_, qy_, reach_;  // reach: the horizontal threshold in the slab
  std::vector<std::int32_t> i0_, i1_, j0_, j1_;   // the cells that it votes for, ends included
  std::vector<std::uint64_t> votes_;              // in the lanes that can hold the match
  std::vector<std::uint32_t> blocks_;  // the block of those cells; kNoBlock if it is larger than 2 x 2
  std::vector<std::uint32_t> large_;   // places of the matches with larger blocks
  // A slab is divided by height into as many lanes as the table has.
  double z_ = 0, half_z_ = 0;
  int lanes_ = kMostLanes;
  bool few_ = true;  // true: few enough matches for the counts of table_
  std::array<std::uint64_t, kMostLanes * kMostLanes> lane_votes_{};  // by first and last lane
  std::array<int, kMostLanes> most_{};
  VoteTable<std::int16_t> table_;
  VoteTable<std::int32_t> wide_table_;  // for very many matches
  std::vector<Entry> entries_;
  std::vector<std::uint32_t> wide_, open_;
};

}  // namespace scanlock
