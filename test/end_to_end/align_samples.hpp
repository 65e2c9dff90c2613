// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// What the tests of scanlock-align share.
#pragma once

#include <doctest/doctest.h>

#include <string>

#include "geometry/rigid.hpp"
#include "process.hpp"

namespace scanlock::test {

/// The first number under this key.
inline double number(const std::string& json, const std::string& key) {
  const std::size_t at = json.find("\"" + key + "\":");
  REQUIRE(at != std::string::npos);
  return std::stod(json.substr(at + key.size() + 3));
}

inline void write_transform(const std::string& path, const Pose& pose) {
  std::string text;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) text += std::to_string(pose.matrix()(row, column)) + " ";
    text += "\n";
  }
  write_file(path, text);
}

}  // namespace scanlock::test
