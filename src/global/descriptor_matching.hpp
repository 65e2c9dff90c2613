// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "global/fpfh.hpp"

namespace scanlock {

/// A row of one matrix of descriptors and a row of another, each among the `rank` nearest of the other, and
/// not both among fewer.
struct MutualPair {
  std::uint32_t a = 0, b = 0;
  int rank = 0;
};

/// The pairs of rank `lambda` at most, ascending by a, then b (section 6.1). Exact but for float rounding;
/// ties go to the smaller row. Both have as many columns; descriptors are finite.
std::vector<MutualPair> mutual_nearest(const Descriptors& a, const Descriptors& b, int lambda);

}  // namespace scanlock
