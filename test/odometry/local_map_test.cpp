// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/local_map.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace {

using namespace scanlock;

constexpr double kVoxel = 0.5;  // metres

/// A row of points along y, one in each voxel.
void add_row(float x, PointCloud* cloud) {
  for (int i = 0; i < 40; ++i)
    cloud->push_back(Eigen::Vector3f(x, 0.1f + static_cast<float>(i) * static_cast<float>(kVoxel), 0.1f));
}

/// Inserts the scans, the last one with another voxel size, at which the map forgets old points at once.
void insert(const std::vector<PointCloud>& scans, LocalMap* map) {
  for (std::size_t i = 0; i < scans.size(); ++i) {
    Keyframe keyframe;
    keyframe.utime = static_cast<std::int64_t>(i);
    keyframe.points = scans[i];
    map->insert(keyframe, i + 1 < scans.size() ? kVoxel : 0.99 * kVoxel);
  }
}

int points_at(float x, const LocalMap& map) {
  int count = 0;
  for (std::uint32_t i = 0; i < map.size(); ++i) {
    count +=
        std::abs(static_cast<double>(map.cloud().x[i]) + map.origin().x() - static_cast<double>(x)) < 1e-4;
  }
  return count;
}

}  // namespace

TEST_CASE("a map keeps the points that its keyframes see, also those first seen by forgotten keyframes") {
  LocalMapLimits limits;
  limits.max_keyframes = 3;
  LocalMap map(limits);
  std::vector<PointCloud> scans(10);
  for (std::size_t i = 0; i < 10; ++i) {
    if (i < 9) add_row(0.1f, &scans[i]);
    add_row(10.1f + static_cast<float>(i), &scans[i]);
  }
  insert(scans, &map);
  CHECK(map.keyframes().size() == 3);
  CHECK(points_at(0.1f, map) == 40);
  for (int i = 0; i < 10; ++i) CHECK(points_at(10.1f + static_cast<float>(i), map) == (i < 7 ? 0 : 40));
}

TEST_CASE("new ground is the share of points in coarse cells that hold no point yet") {
  LocalMap map(LocalMapLimits{});
  const auto share = [&](const std::vector<float>& rows) {
    Keyframe keyframe;
    for (const float x : rows) add_row(x, &keyframe.points);
    return map.insert(keyframe, kVoxel);
  };
  CHECK(share({0.1f}) == 1.0);
  CHECK(share({0.7f}) == 0.0);  // other voxels
  CHECK(share({0.7f, 1.9f, 2.1f, 6.1f}) == 0.5);
  CHECK(share({0.1f, 2.1f, 6.1f}) == 0.0);
}

TEST_CASE(
    "points of given keyframes replace points in their voxels, and given keyframes do not count as own") {
  LocalMapLimits limits;
  limits.max_keyframes = 2;
  LocalMap map(limits);
  const auto keyframe = [](float x, std::int64_t utime) {
    Keyframe result;
    result.utime = utime;
    add_row(x, &result.points);
    return result;
  };
  const auto given = [&](float x, std::uint32_t id) {
    Keyframe result = keyframe(x, 0);
    result.given = id;
    return result;
  };
  map.insert(keyframe(0.1f, 1), kVoxel);
  map.insert(keyframe(5.1f, 2), kVoxel);
  map.found_on({given(0.15f, 3), given(9.1f, 4)}, kVoxel);
  CHECK(map.keyframes().size() == 4);
  CHECK(points_at(0.1f, map) == 0);
  CHECK(points_at(0.15f, map) == 40);  // in the same voxels as the row at 0.1 m
  CHECK(points_at(5.1f, map) == 40);
  CHECK(points_at(9.1f, map) == 40);
  map.insert(keyframe(7.1f, 5), 0.99 * kVoxel);  // the oldest keyframe that was not given is forgotten
  CHECK(map.keyframes().size() == 4);
  CHECK(points_at(5.1f, map) == 40);
  for (const float x : {11.1f, 13.1f}) map.insert(keyframe(x, 6), 0.99 * kVoxel);
  CHECK(map.keyframes().size() == 6);  // so few new points make the map forget no keyframe
  map.found_on({given(9.1f, 4)}, 0.99 * kVoxel);
  CHECK(map.keyframes().size() == 3);
  CHECK(points_at(7.1f, map) == 0);
  CHECK(points_at(11.1f, map) == 40);
  map.found_on({given(20.1f, 6)}, kVoxel);
  CHECK(map.keyframes().size() == 3);
  CHECK(points_at(9.1f, map) == 0);
}

TEST_CASE("a map that is founded anew step by step equals the map that is founded at once") {
  const auto given = [](std::uint32_t id, bool with_points) {
    Keyframe result;
    result.given = id;
    result.map_from_body.translation().x() = 3.0 * id;
    if (!with_points) return result;
    add_row(0.1f, &result.points);  // one row of each of two keyframes is in the same voxels
    add_row(3.1f, &result.points);
    return result;
  };
  Keyframe own;
  add_row(6.15f, &own.points);
  add_row(50.1f, &own.points);
  LocalMap step_by_step(LocalMapLimits{});
  step_by_step.insert(own, kVoxel);
  const Pose elsewhere(Eigen::Translation3d(3, 0, 0.5));
  for (std::uint32_t first = 0; first < 5; ++first) {
    std::vector<Keyframe> some, all;
    for (std::uint32_t id = first; id < first + 3; ++id) {
      const Keyframe wanted = given(id, true);
      some.push_back(given(id, !step_by_step.has(id, wanted.map_from_body)));
      all.push_back(wanted);
    }
    CHECK(step_by_step.has(first, all[0].map_from_body) == (first > 0));
    CHECK_FALSE(step_by_step.has(first, elsewhere));
    step_by_step.found_on(some, kVoxel);
    LocalMap at_once(LocalMapLimits{});
    at_once.insert(own, kVoxel);
    at_once.found_on(all, kVoxel);
    CHECK(step_by_step.keyframes().size() == 4);
    CHECK(step_by_step.size() == at_once.size());
    for (int row = 0; row < 10; ++row) {
      CAPTURE(first);
      CAPTURE(row);
      // In voxels that the robot itself has seen, too, the given point stays.
      if (row != 2 || first < 3)
        CHECK(points_at(0.1f + 3.0f * static_cast<float>(row), step_by_step) ==
              points_at(0.1f + 3.0f * static_cast<float>(row), at_once));
    }
    CHECK(points_at(50.1f, step_by_step) == 40);
  }
  CHECK(points_at(6.1f, step_by_step) == 40);
  step_by_step.found_on({}, kVoxel);
  CHECK(step_by_step.keyframes().size() == 1);
  CHECK(step_by_step.size() == 80);
  LocalMap of_none(LocalMapLimits{});
  of_none.found_on({}, kVoxel);
  CHECK(of_none.size() == 0);
}

TEST_CASE("given keyframes too far from the robot are forgotten, and the points that only they show") {
  LocalMapLimits limits;
  limits.max_distance = 50;
  const auto keyframe_at = [](float x) {
    Keyframe result;
    result.map_from_body.translation().x() = x;
    add_row(0.1f, &result.points);
    return result;
  };
  LocalMap map(limits);
  std::vector<Keyframe> given{keyframe_at(0), keyframe_at(40)};
  given[0].given = 1;
  given[1].given = 2;
  map.insert(keyframe_at(2), kVoxel);
  map.found_on(given, kVoxel);
  CHECK(map.is_founded());
  double voxel = kVoxel;
  const auto other_voxel = [&] { return voxel = voxel == kVoxel ? 0.99 * kVoxel : kVoxel; };
  for (const float x : {45.0f, 51.0f, 89.0f}) {
    map.insert(keyframe_at(x), other_voxel());  // after which all points are indexed together
    CAPTURE(x);
    CHECK(points_at(0.1f, map) == (x < 50 ? 40 : 0));
    CHECK(points_at(2.1f, map) == (x < 52 ? 40 : 0));
    CHECK(points_at(40.1f, map) == 40);
  }
  map.insert(keyframe_at(95), other_voxel());
  CHECK_FALSE(map.is_founded());
  CHECK(points_at(40.1f, map) == 0);
  CHECK(points_at(45.1f, map) == 40);
}

TEST_CASE("a map that is loaded equals the map of the same inserted keyframes") {
  LocalMapLimits limits;
  limits.max_keyframes = 3;
  limits.max_distance = 50;
  LocalMap inserted(limits), loaded(limits);
  std::vector<Keyframe> keyframes(6);
  for (std::size_t i = 0; i < 6; ++i) {
    keyframes[i].map_from_body.translation().x() = i == 4 ? 120.0 : 7.0;
    add_row(0.1f, &keyframes[i].points);
    add_row(10.1f + static_cast<float>(i), &keyframes[i].points);
    inserted.insert(keyframes[i], i < 5 ? kVoxel : 0.99 * kVoxel);
  }
  loaded.load({Keyframe{}}, kVoxel);  // has no points
  loaded.load(keyframes, 0.99 * kVoxel);
  CHECK(loaded.keyframes().size() == 3);
  CHECK(loaded.keyframes().back().id > loaded.keyframes().front().id);
  for (int i = 0; i < 6; ++i) {
    const float x = (i == 4 ? 120.0f : 7.0f) + 10.1f + static_cast<float>(i);
    CAPTURE(i);
    CHECK(points_at(x, loaded) == points_at(x, inserted));
  }
  CHECK(points_at(7.1f, loaded) == 40);
  Neighbour nearest;
  REQUIRE(loaded.target().tree.k_nearest(loaded.cloud().point(5), 1, &nearest, 1.0f) == 1);
  CHECK(nearest.index == 5);
  loaded.load({}, kVoxel);
  CHECK(loaded.empty());
  CHECK(loaded.size() == 0);
}

TEST_CASE("the first point of a voxel stays, so that the map does not creep") {
  LocalMapLimits limits;
  limits.max_keyframes = 2;
  LocalMap map(limits);
  std::vector<PointCloud> scans(6);
  for (std::size_t i = 0; i < 6; ++i) add_row(0.1f + 0.05f * static_cast<float>(i), &scans[i]);
  insert(scans, &map);
  CHECK(points_at(0.1f, map) == 40);
  CHECK(map.size() == 40);
}
