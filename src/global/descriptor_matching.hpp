// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "global/fpfh.hpp"

namespace scanlock {

/// Row `a` of one matrix of descriptors and row `b` of another; `rank` is the smallest number such that each
/// is among the `rank` nearest rows of the other.
struct MutualPair {
  std::uint32_t a = 0, b = 0;
  int rank = 0;
};

/// The pairs of rank `lambda` at most, ascending by a, then b (section 6.1). Exact up to float rounding; ties
/// go to the smaller row. Both matrices have the same number of columns, else throws std::invalid_argument;
/// descriptors are finite.
std::vector<MutualPair> mutual_nearest(const Descriptors& a, const Descriptors& b, int lambda);

}  // namespace scanlock
