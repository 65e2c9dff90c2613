// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "daemon/config.hpp"

namespace scanlock {

template <typename T>
using Access = std::function<T&(Config&)>;

/// One key of the configuration. Reading, checking and printing all use the table config_keys(), the only
/// list of keys.
struct ConfigKey {
  std::string section, name, unit;
  double min,
      max;  ///< inclusive; of a number, the length of a string, or the number of strings in a list
  std::string help;
  std::vector<std::string> choices;  ///< of a string; empty: any text
  std::variant<Access<bool>, Access<int>, Access<double>, Access<std::string>,
               Access<std::vector<std::string>>>
      access;
};

/// In the order in which they are printed; the keys of a section are adjacent.
const std::vector<ConfigKey>& config_keys();

}  // namespace scanlock
