// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>

namespace scanlock {

/// Counts in square cells, shared by all whose (i, j) are the same modulo the side: sharing only raises a
/// count. A cell has eight bytes of `Lane`s, each a count of its own, and a vote is added to any of them at
/// once: bits of the first kLanes of a mask say to which.
///
/// A vote for a block of one or two cells by one or two is one addition, to a table of its shape; the four
/// tables are summed afterwards.
template <typename Lane>
class VoteTable {
 public:
  static constexpr int kSide = 32, kLanes = 8 / sizeof(Lane);
  static constexpr std::size_t kMost = std::numeric_limits<Lane>::max();  // votes that cannot overflow

  /// Where to add a vote for the block of cells with its lowest at (i, j), of two cells along i, along j.
  static constexpr std::uint32_t kTwoAlongI = kSide * kSide, kTwoAlongJ = 2 * kSide * kSide;
  /// Votes for this count nowhere; after mark() it is not marked, and the one that follows is.
  static constexpr std::uint32_t kNoBlock = 4 * kSide * kSide, kMarkedBlock = kNoBlock + 1;
  static std::uint32_t block(std::int32_t i, std::int32_t j) {
    return static_cast<std::uint32_t>((j & (kSide - 1)) * kSide + (i & (kSide - 1)));
  }
  /// A vote in lane `lane`; sums of such are votes, too.
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
  /// After the last vote: counts the cells, and returns the fullest, lane by lane.
  std::array<Lane, kLanes> count() {
    Row two_up, two_up_below;  // what counts in the row and the one above
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
  /// Marks the blocks that have a cell with a count of at least so many. The votes are gone then.
  void mark(int least) {
    for (std::size_t s = 0; s < kCells; ++s) blocks_[s] = static_cast<Lane>(counts_[s] >= least ? -1 : 0);
    const Lane *one = blocks_.data(), *two = one + kTwoAlongI * kLanes;
    for (std::size_t row = 0; row < kCells; row += kRow) join(one + row, kRow, &blocks_[kCells + row]);
    join(one, kCells, &blocks_[kTwoAlongJ * kLanes]);
    join(two, kCells, &blocks_[(kTwoAlongI + kTwoAlongJ) * kLanes]);
    std::fill_n(&blocks_[kNoBlock * kLanes], kLanes, Lane{0});
    std::fill_n(&blocks_[kMarkedBlock * kLanes], kLanes, static_cast<Lane>(-1));
  }
  /// Not 0 where a lane of the vote was marked.
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
  /// Sums a row of single cells and the row of pairs that belongs to it.
  static void add_along_row(const Lane* single, Row& sum) {
    const Lane* pair = single + kTwoAlongI * kLanes;
    for (std::size_t x = 0; x < kLanes; ++x)
      sum[x] = static_cast<Lane>(single[x] + pair[x] + pair[kRow - kLanes + x]);
    for (std::size_t x = kLanes; x < kRow; ++x)
      sum[x] = static_cast<Lane>(single[x] + pair[x] + pair[x - kLanes]);
  }
  /// Joins the marks of each block with those of the next: a cell on, or a row on, around the end.
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
