// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>

namespace scanlock {

/// Counts of votes in square cells. Cells whose (i, j) are equal modulo the side share a count: sharing only
/// raises it. A cell has eight bytes of `Lane`s, each a separate count, and one 64-bit addition adds a vote
/// to any of them: a vote has a 1 in each lane to be raised, see vote_in().
///
/// A vote for a block of 1 x 1, 2 x 1, 1 x 2 or 2 x 2 cells is one addition, to the table of that shape; the
/// four tables are summed afterwards.
template <typename Lane>
class VoteTable {
 public:
  static constexpr int kSide = 32, kLanes = 8 / sizeof(Lane);
  static constexpr std::size_t kMost = std::numeric_limits<Lane>::max();  // votes that cannot overflow

  /// Index of the block whose lowest cell is (i, j): block(i, j), plus these for two cells along i, along j.
  static constexpr std::uint32_t kTwoAlongI = kSide * kSide, kTwoAlongJ = 2 * kSide * kSide;
  /// Two blocks without cells: votes for kNoBlock count nowhere; mark() clears kNoBlock and marks
  /// kMarkedBlock.
  static constexpr std::uint32_t kNoBlock = 4 * kSide * kSide, kMarkedBlock = kNoBlock + 1;
  static std::uint32_t block(std::int32_t i, std::int32_t j) {
    return static_cast<std::uint32_t>((j & (kSide - 1)) * kSide + (i & (kSide - 1)));
  }
  /// A vote in lane `lane`; sums of votes in different lanes are votes, too.
  static std::uint64_t vote_in(int lane) {
    std::array<Lane, kLanes> lanes{};
    lanes[static_cast<std::size_t>(lane)] = 1;
    return packed(lanes.data());
  }

  void clear() { blocks_.fill(0); }
  void add(std::uint32_t block, std::uint64_t vote) {
    Lane* at = &blocks_[std::size_t{block} * kLanes];
    const std::uint64_t sum = packed(at) + vote;
    std::memcpy(at, &sum, sizeof sum);
  }
  /// After the last vote: counts the votes of all cells; returns the largest count of each lane.
  std::array<Lane, kLanes> count() {
    Row two_up, two_up_below;  // votes for two cells along j, from this row and from the row below
    add_along_row(&blocks_[kTwoAlongJ * kLanes + kCells - kRow], two_up_below);
    Row high{};
    for (std::size_t row = 0; row < kCells; row += kRow) {
      Row here;
      add_along_row(&blocks_[row], here);
      add_along_row(&blocks_[kTwoAlongJ * kLanes + row], two_up);
      for (std::size_t x = 0; x < kRow; ++x) {
        counts_[row + x] = static_cast<Lane>(here[x] + two_up[x] + two_up_below[x]);
        high[x] = std::max(high[x], counts_[row + x]);
      }
      two_up_below = two_up;
    }
    std::array<Lane, kLanes> result{};
    for (std::size_t x = 0; x < kRow; ++x) result[x % kLanes] = std::max(result[x % kLanes], high[x]);
    return result;
  }
  /// Marks the blocks with a cell whose count is at least `least`. The marks replace the votes.
  void mark(int least) {
    for (std::size_t s = 0; s < kCells; ++s) blocks_[s] = static_cast<Lane>(counts_[s] >= least ? -1 : 0);
    const Lane *one = blocks_.data(), *two = one + kTwoAlongI * kLanes;
    for (std::size_t row = 0; row < kCells; row += kRow) join(one + row, kRow, &blocks_[kCells + row]);
    join(one, kCells, &blocks_[kTwoAlongJ * kLanes]);
    join(two, kCells, &blocks_[(kTwoAlongI + kTwoAlongJ) * kLanes]);
    std::fill_n(&blocks_[kNoBlock * kLanes], kLanes, Lane{0});
    std::fill_n(&blocks_[kMarkedBlock * kLanes], kLanes, static_cast<Lane>(-1));
  }
  /// Not 0 if a lane of the vote is marked.
  std::uint64_t marked(std::uint32_t block, std::uint64_t vote) const {
    return packed(&blocks_[std::size_t{block} * kLanes]) & vote;
  }

 private:
  static constexpr std::size_t kRow = std::size_t{kSide} * kLanes, kCells = kSide * kRow;
  using Row = std::array<Lane, kRow>;

  static std::uint64_t packed(const Lane* lanes) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, lanes, sizeof bits);
    return bits;
  }
  /// Sums a row of single cells and the row of pairs along i at the same place.
  static void add_along_row(const Lane* single, Row& sum) {
    const Lane* pair = single + kTwoAlongI * kLanes;
    for (std::size_t x = 0; x < kLanes; ++x)
      sum[x] = static_cast<Lane>(single[x] + pair[x] + pair[kRow - kLanes + x]);
    for (std::size_t x = kLanes; x < kRow; ++x)
      sum[x] = static_cast<Lane>(single[x] + pair[x] + pair[x - kLanes]);
  }
  /// Combines the marks of each block with those of the next block, along i or along j, cyclically.
  static void join(const Lane* marks, std::size_t size, Lane* joined) {
    const std::size_t step = size == kRow ? kLanes : kRow;
    for (std::size_t x = 0; x + step < size; ++x) joined[x] = static_cast<Lane>(marks[x] | marks[x + step]);
    for (std::size_t x = size - step; x < size; ++x)
      joined[x] = static_cast<Lane>(marks[x] | marks[x + step - size]);
  }

  std::array<Lane, 4 * kCells + 2 * kLanes> blocks_{};  // by shape: votes, then marks
  std::array<Lane, kCells> counts_{};
};

}  // namespace scanlock
