// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace scanlock {

/// The element of `names` that a user probably meant by `word`: one that starts with `word`, else the one at
/// the smallest edit distance. Empty when that distance is more than 3, or not below the length of `word`.
std::string nearest_name(const std::string& word, const std::vector<std::string>& names);

}  // namespace scanlock
