// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "evaluation/map_picture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

using namespace scanlock;

namespace {

std::size_t times_in(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

/// A floor of 10 m x 10 m with noise, its ceiling, and a wall of 2 m height along y = 5.
PointCloud room_with_wall() {
  PointCloud cloud;
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 100; ++j) {
      const float x = 0.1F * static_cast<float>(i), y = 0.1F * static_cast<float>(j);
      cloud.push_back(x, y, j % 2 == 0 ? 0.01F : -0.01F);
      cloud.push_back(x, y, 2.5F);
    }
    for (int k = 0; k < 20; ++k)
      cloud.push_back(0.1F * static_cast<float>(i), 5, 0.1F * static_cast<float>(k));
  }
  return cloud;
}

}  // namespace

TEST_CASE(
    "a map picture shows walls without the floor, the path, and each relocalisation with time and reason") {
  MapPicture picture;
  picture.map = room_with_wall();
  picture.ways = {{{1, 1, 0}, {4, 1, 0}}, {{6, 1, 0}, {9, 1, 0}}};
  picture.corrections = {{{6, 1, 0}, 12.5, "24 of 1000 matches agree & nothing contradicts"}};
  picture.title = "drive.lcmlog in site.map";
  const std::string svg = map_svg(picture);
  CHECK(times_in(svg, "class=\"way\"") == 2);
  CHECK(times_in(svg, "class=\"place\"") == 1);
  CHECK(times_in(svg, "1  at 12.5 s: 24 of 1000 matches agree &amp; nothing contradicts") == 1);
  CHECK(times_in(svg, "drive.lcmlog in site.map") == 1);
  const std::size_t dots = times_in(svg, "h0");
  CHECK(dots >= 90);  // the points of the wall
  CHECK(dots <= 120);
  picture.map = {};
  picture.ways.clear();
  picture.corrections.resize(100, picture.corrections.front());
  CHECK(times_in(map_svg(picture), "matches agree") == 12);  // further ones are drawn without a label
}
