// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/seen_space.hpp"

#include <doctest/doctest.h>

namespace scanlock {
namespace {

const Eigen::Vector3f kAlongX = Eigen::Vector3f::UnitX(), kAlongY = Eigen::Vector3f::UnitY();
const Eigen::Vector3f kNoNormal = Eigen::Vector3f::Zero();

/// A wall across the x axis at 10 m, 4 m wide and 6 m high.
PointCloud wall() {
  PointCloud cloud;
  for (int y = -4; y <= 4; ++y) {
    for (int z = -6; z <= 6; ++z)
      cloud.push_back(10, 0.5f * static_cast<float>(y), 0.5f * static_cast<float>(z));
  }
  for (auto* v : {&cloud.nx, &cloud.ny, &cloud.nz}) v->assign(cloud.size(), 0.0f);
  cloud.nx.assign(cloud.size(), -1.0f);
  return cloud;
}

}  // namespace

TEST_CASE("a point is crossed where a ray passed through it, unless the ray grazed its surface") {
  const SeenSpace space(wall(), 0.5f);
  CHECK(space.is_crossed({5, 0, 0}, kAlongX));
  CHECK(space.is_crossed({5, 0, 0}, kNoNormal));
  CHECK(space.is_crossed({5, 0, 0}, Eigen::Vector3f(1, 1, 0).normalized()));
  CHECK_FALSE(space.is_crossed({5, 0, 0}, kAlongY));
  CHECK_FALSE(space.is_crossed({5, 5, 0}, kAlongX));     // beside all rays
  CHECK_FALSE(space.is_crossed({9.7f, 0, 0}, kAlongX));  // at their end
  CHECK_FALSE(space.is_crossed({12, 0, 0}, kAlongX));
  CHECK(space.was_seen_through({5, 0, 0}));
  CHECK_FALSE(space.was_seen_through({5, 5, 0}));
  CHECK(space.has_surface({10, 0, 0}));
  CHECK(space.has_surface({10.4f, 0, 0}));
  CHECK_FALSE(space.has_surface({8, 0, 0}));
}

TEST_CASE("a point is above if it is higher than the points and rays of a known column") {
  const SeenSpace space(wall(), 0.5f);  // at 10 m, from 3 m below the sensor to 3 m above it
  CHECK(space.is_above({10, 0, 5}));
  CHECK_FALSE(space.is_above({10, 0, 2}));
  CHECK_FALSE(space.is_above({10, 0, -5}));
  CHECK(space.is_above({5, 0, 3}));  // rays pass there, but lower
  CHECK_FALSE(space.is_above({5, 0, 1}));
  CHECK_FALSE(space.is_above({5, 5, 3}));   // neither a ray nor a point
  CHECK_FALSE(space.is_above({12, 0, 5}));  // behind the wall
  CHECK_FALSE(space.is_above({1e6f, 0, 5}));
  CHECK_FALSE(SeenSpace(PointCloud{}, 0.5f).is_above({0, 0, 9}));
}

TEST_CASE("rays start at the viewpoint of each point") {
  PointCloud cloud = wall();
  cloud.viewpoints.assign(cloud.size(), {18, 0, 0});
  const SeenSpace space(cloud, 0.5f);
  CHECK(space.is_crossed({15, 0, 0}, kAlongX));
  CHECK_FALSE(space.is_crossed({5, 0, 0}, kAlongX));
}

TEST_CASE("rays that skim over the ground do not contradict the ground") {
  PointCloud ground;  // in rings, 1 m below the sensor
  for (int i = 0; i < 3600; ++i) {
    const float angle = 0.00174533f * static_cast<float>(i), range = i % 2 == 0 ? 6.0f : 14.0f;
    ground.push_back(range * std::cos(angle), range * std::sin(angle), -1);
  }
  for (auto* v : {&ground.nx, &ground.ny, &ground.nz}) v->assign(ground.size(), 0.0f);
  ground.nz.assign(ground.size(), 1.0f);
  const SeenSpace space(ground, 0.3f);
  CHECK_FALSE(space.is_crossed({10, 0, -1}, kNoNormal));
  CHECK_FALSE(space.has_surface({6, 0, -1}));  // a level surface
}

TEST_CASE("a point hundreds of kilometres away adds no free space, and does not affect that of the others") {
  PointCloud cloud = wall();
  cloud.push_back(4e5f, -4e5f, 4e5f);
  cloud.nx.push_back(1);
  cloud.ny.push_back(0);
  cloud.nz.push_back(0);
  const SeenSpace space(cloud, 0.5f);
  CHECK(space.is_crossed({5, 0, 0}, kAlongX));
  CHECK_FALSE(space.is_crossed({4e5f, -4e5f, 4e5f}, kAlongX));
}

TEST_CASE("a point at its own viewpoint has no ray") {
  PointCloud cloud = wall();
  cloud.viewpoints = std::vector<Eigen::Vector3f>(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.viewpoints[i] = cloud.point(i);
  CHECK_FALSE(SeenSpace(cloud, 0.5f).is_crossed({5, 0, 0}, kNoNormal));
  CHECK_FALSE(SeenSpace(PointCloud{}, 0.5f).is_crossed({0, 0, 0}, kNoNormal));
}

}  // namespace scanlock
