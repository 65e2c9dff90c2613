// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

/// How many of `count` like trials to make. The sanitisers, which are ten times slower, look for other faults
/// than wrong answers: a tenth of the trials shows those.
constexpr int trials(int count) {
#ifdef __SANITIZE_ADDRESS__
  return std::max(count / 10, std::min(count, 2));
#else
  return count;
#endif
}
