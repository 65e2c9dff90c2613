// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/ground_height.hpp"

#include <doctest/doctest.h>

namespace scanlock {
namespace {

void add(PointCloud* cloud, const Eigen::Vector3f& p, float nz) {
  cloud->push_back(p);
  cloud->nx.push_back(nz == 0.0f ? 1.0f : 0.0f);
  cloud->ny.push_back(0);
  cloud->nz.push_back(nz);
}

/// Adds a square of surface whose normal points up (1) or down (-1), or is horizontal (0).
void add_square(PointCloud* cloud, const Eigen::Vector3f& corner, float size, float nz) {
  for (float x = 0; x < size; x += 0.1f) {
    for (float y = 0; y < size; y += 0.1f) add(cloud, corner + Eigen::Vector3f(x, y, 0), nz);
  }
}

}  // namespace

TEST_CASE("a sensor's height is that above the floor, not above a table or below a ceiling") {
  PointCloud room;
  add_square(&room, {-4, -4, -1.3f}, 8, 1);
  add_square(&room, {-4, -4, 1.2f}, 8, -1);
  add_square(&room, {0.3f, -0.5f, -0.6f}, 0.8f, 1);  // a table
  add_square(&room, {1, 1, -2.5f}, 1, 0);            // upright surface below the floor: a shaft
  const std::optional<float> height = height_above_ground(room, 0.8f);
  REQUIRE(height);
  CHECK(*height == doctest::Approx(1.3f));
}

TEST_CASE("a floor that begins 3 m from the sensor gives its height") {
  PointCloud floor;
  add_square(&floor, {3, -2, -0.9f}, 4, 1);
  add_square(&floor, {40, 0, -7}, 4, 1);  // at the foot of a hill
  const std::optional<float> height = height_above_ground(floor, 0.8f);
  REQUIRE(height);
  CHECK(*height == doctest::Approx(0.9f));
}

TEST_CASE("a cloud without a level surface below the sensor gives no height") {
  PointCloud ceiling;
  add_square(&ceiling, {-4, -4, 1.2f}, 8, 1);
  add_square(&ceiling, {-4, -4, -1.2f}, 8, 0);
  CHECK_FALSE(height_above_ground(ceiling, 0.8f));
  CHECK_FALSE(height_above_ground(PointCloud(), 0.8f));
}

TEST_CASE("the height of a point is that above the lowest point nearby") {
  PointCloud cloud;
  add_square(&cloud, {0, 0, 5}, 2, 1);
  add(&cloud, {1, 1, 7}, 0);
  add(&cloud, {9, 9, 7}, 0);
  const std::vector<float> heights = heights_above_ground(cloud, 0.5f);
  CHECK(heights[cloud.size() - 2] == doctest::Approx(2));
  CHECK(heights.back() == doctest::Approx(0));
}

}  // namespace scanlock
