// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

#include "geometry/match.hpp"

namespace scanlock {

/// A file with more matches is rejected: the solver needs about 300 bytes per match.
inline constexpr std::size_t kMostMatches = 20'000'000;

/// Reads candidate matches, one per line: `px py pz qx qy qz`, metres; `#` starts a comment. Throws
/// std::runtime_error naming the file, and the line if one is at fault, for a line without six finite
/// numbers, a file without matches, and more than `most` matches.
Matches read_matches(const std::string& path, std::size_t most = kMostMatches);

}  // namespace scanlock
