// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "global/matches.hpp"
#include "global/pose_box.hpp"

namespace scanlock {

/// Poses with z in a slab and theta in a sector, whatever x and y; divided into square cells of (x, y).
struct Sector {
  double z = 0, half_z = 0;          ///< metres
  double theta = 0, half_theta = 0;  ///< radians, half_theta at most pi / 8
  double cell = 1;                   ///< metres
};

/// One cell of a sector that some matches may be held in.
struct VotedCell {
  PoseBox box;
  std::vector<std::uint32_t> matches;
};

/// Bounds whole sectors of poses at once: each match votes for every cell of horizontal translations in which
/// some angle and height of the sector holds it, so the fullest cell bounds the consensus in the sector. This
/// costs some nanoseconds a match, without a sort or an angle, and does not depend on how many matches there
/// are in a cell. Cells share a small table, (i, j) modulo its side: sharing only raises a count.
class SectorVoting {
 public:
  explicit SectorVoting(const LevelMatches& matches);

  /// Metres; sectors must not have smaller cells.
  double smallest_cell() const { return smallest_cell_; }

  /// Takes the matches that a slab of heights can hold; returns how many these are.
  std::size_t load_slab(double z, double half_z);
  /// The same, of the given matches only.
  std::size_t load(const std::vector<std::uint32_t>& matches, double z, double half_z);
  /// The bound of a sector of the slab.
  int vote(const Sector& sector);
  /// The matches that voted, the last time, for a cell of at least so many.
  void open_matches(int at_least, std::vector<std::uint32_t>& matches) const;
  /// How many matches stand in the cells of the last vote with at least so many, cell by cell.
  std::size_t members(int at_least) const;
  /// The cells, of the last vote, of at least so many matches. Nothing and false when as many matches as that
  /// sweep far over the cells, for the sector is too wide for their distance from the axis.
  bool gather(const Sector& sector, int at_least, std::vector<VotedCell>& cells);

 private:
  static constexpr int kSide = 64;
  static std::uint32_t slot(std::int32_t i, std::int32_t j) {
    return static_cast<std::uint32_t>((j & (kSide - 1)) * kSide + (i & (kSide - 1)));
  }
  struct Entry {
    std::uint64_t cell;
    std::uint32_t match;
  };
  bool is_wide(std::size_t k) const { return i1_[k] - i0_[k] >= kSide || j1_[k] - j0_[k] >= kSide; }
  PoseBox cell_box(const Sector& sector, std::uint64_t cell) const;
  void find_spans(const Sector& sector);

  void resize(std::size_t n);
  std::size_t load_one(std::size_t place, std::uint32_t match, double z, double half_z);

  struct Narrow {
    float px, py, qx, qy;
  };
  const LevelMatches& m_;
  std::vector<Narrow> narrow_;
  float offset_ = 0, margin_ = 0;
  double smallest_cell_ = 0;
  std::vector<std::uint32_t> matches_;            // loaded, and what they are:
  std::vector<float> px_, py_, qx_, qy_, reach_;  // reach: the horizontal threshold in the slab
  std::vector<std::int32_t> i0_, i1_, j0_, j1_;   // the cells that they vote for, ends included
  std::array<std::uint32_t, kSide * kSide> table_{};
  std::vector<Entry> entries_;
  std::vector<std::uint32_t> wide_;
};

}  // namespace scanlock
