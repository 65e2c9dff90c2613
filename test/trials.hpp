// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <vector>

/// Whether all trials, seeds and frames of a test case are run (SCANLOCK_ALL_TRIALS, which tools/check --all
/// sets), or only a sample of them. Under the sanitisers, which are ten times slower, few trials suffice:
/// these builds look for memory errors and races, not for wrong answers.
#ifdef __SANITIZE_ADDRESS__
constexpr bool kSanitised = true;
#else
constexpr bool kSanitised = false;
#endif

inline bool all_trials() {
  return !kSanitised && std::getenv("SCANLOCK_ALL_TRIALS") != nullptr;
}

/// How many of `count` similar trials to run: all, or a quarter, or under the sanitisers a tenth, but at
/// least 2.
inline int trials(int count) {
  return all_trials() ? count : std::max(count / (kSanitised ? 10 : 4), std::min(count, 2));
}

/// All seeds, or the first one.
inline std::vector<std::uint64_t> seeds(std::initializer_list<std::uint64_t> all) {
  return {all.begin(), all_trials() ? all.end() : all.begin() + 1};
}
