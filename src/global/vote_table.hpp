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
template <typename Lane>
class VoteTable {
 public:
  static constexpr int kSide = 32, kLanes = 8 / sizeof(Lane);
  static constexpr std::size_t kMost = std::numeric_limits<Lane>::max();  // votes that cannot overflow

  static std::size_t slot(std::int32_t i, std::int32_t j) {
    return static_cast<std::size_t>((j & (kSide - 1)) * kSide + (i & (kSide - 1)));
  }
  /// A vote in lane `lane`; sums of such are votes, too.
  static std::uint64_t vote_in(int lane) {
    std::array<Lane, kLanes> lanes{};
    lanes[static_cast<std::size_t>(lane)] = 1;
    return packed(lanes.data());
  }

  void clear() { counts_.fill(0); }
  void add(std::size_t slot, std::uint64_t vote) {
    Lane* at = &counts_[slot * kLanes];
    const std::uint64_t sum = packed(at) + vote;
    std::memcpy(at, &sum, sizeof sum);
  }
  /// The fullest cell, lane by lane.
  std::array<Lane, kLanes> most() const {
    constexpr std::size_t kStep = 16 / sizeof(Lane);  // a vector register of any machine
    std::array<Lane, kStep> high{};
    for (std::size_t s = 0; s < counts_.size(); s += kStep) {
      for (std::size_t l = 0; l < kStep; ++l) high[l] = std::max(high[l], counts_[s + l]);
    }
    std::array<Lane, kLanes> result{};
    for (std::size_t l = 0; l < kStep; ++l) result[l % kLanes] = std::max(result[l % kLanes], high[l]);
    return result;
  }
  /// Marks the counts of at least so many.
  void mark(int least) {
    for (std::size_t s = 0; s < counts_.size(); ++s)
      marks_[s] = static_cast<Lane>(counts_[s] >= least ? -1 : 0);
  }
  /// Not 0 where a lane of the vote was marked.
  std::uint64_t marked(std::size_t slot, std::uint64_t vote) const {
    return packed(&marks_[slot * kLanes]) & vote;
  }

 private:
  static std::uint64_t packed(const Lane* lanes) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, lanes, sizeof bits);
    return bits;
  }
  std::array<Lane, std::size_t{kSide} * kSide * kLanes> counts_{}, marks_{};
};

}  // namespace scanlock
