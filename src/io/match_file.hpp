// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

#include "geometry/match.hpp"

namespace scanlock {

/// More matches than this are refused: the solver needs about 300 bytes for each.
inline constexpr std::size_t kMostMatches = 20'000'000;

/// Reads candidate matches, one a line: `px py pz qx qy qz`, metres; `#` starts a comment.
/// Throws std::runtime_error naming the file, and the line where one is at fault: not six finite numbers, no
/// match at all, or more than `most` of them.
Matches read_matches(const std::string& path, std::size_t most = kMostMatches);

}  // namespace scanlock
