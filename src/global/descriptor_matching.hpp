// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "global/fpfh.hpp"

namespace scanlock {

/// The pairs (row of a, row of b) whose descriptors are each among the `lambda` nearest of the other, in
/// ascending order (section 6.1). Exact but for float rounding; ties go to the smaller row. a and b have as
/// many columns; descriptors are finite.
std::vector<std::pair<std::uint32_t, std::uint32_t>> mutual_nearest(const Descriptors& a,
                                                                    const Descriptors& b, int lambda);

}  // namespace scanlock
