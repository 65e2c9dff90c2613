// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Sample clouds and functions for the tests of scanlock-align.
#pragma once

#include <doctest/doctest.h>

#include <random>
#include <string>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "process.hpp"

namespace scanlock::test {

/// Three walls and a slope, 3000 points.
inline PointCloud corner(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> side(0, 4);
  PointCloud cloud;
  for (int i = 0; i < 3000; ++i) {
    const float a = side(random), b = side(random);
    if (i % 4 == 0) cloud.push_back(a, b, 0);
    if (i % 4 == 1) cloud.push_back(a, 0, b);
    if (i % 4 == 2) cloud.push_back(0, a, b);
    if (i % 4 == 3) cloud.push_back(4 + 0.3f * b, a, b);
  }
  return cloud;
}

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
