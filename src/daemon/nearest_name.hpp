// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace scanlock {

/// The one of `names` that a person probably meant by `word`: one that begins so, else the one that takes the
/// fewest letters to insert, delete or replace. Empty where that takes more than three, or all of the word.
std::string nearest_name(const std::string& word, const std::vector<std::string>& names);

}  // namespace scanlock
