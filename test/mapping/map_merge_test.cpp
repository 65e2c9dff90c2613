// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/map_merge.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>
#include <utility>

#include "../odometry/room.hpp"
#include "mapping/loop_closure.hpp"

namespace scanlock {
namespace {

/// The frame of a map in the hall: the pose at which its drive began.
Pose frame_in_hall(double x, double y, double heading) {
  return at(x, y, heading);
}

/// A drive along the hall from one x to another, `aside` metres beside its middle. `stretch`: factor of the
/// points' x, 1 in the hall itself; `noise`: standard deviation of each coordinate, metres.
SavedMap drive(const Pose& hall_from_map, double from, double to, double aside, unsigned seed,
               float stretch = 1, float noise = 0) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  KeyframeArchive archive(std::numeric_limits<std::size_t>::max());
  SavedMap map;
  const double step = from < to ? 1.0 : -1.0;
  for (double x = from; step * x <= step * to; x += step) {
    const Pose hall_from_body = at(x, aside, 0.3 * x);
    const auto utime = static_cast<std::int64_t>(1000000 * (archive.keyframes().size() + 1));
    PointCloud points = hall_scan(hall_from_body, Vector6::Zero(), utime, seed++, 0.1, 3000).points;
    const Eigen::Matrix3f turn = hall_from_body.linear().cast<float>();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3f p =
          turn.transpose() * Eigen::Vector3f(stretch, 1, 1).cwiseProduct(turn * points.point(i));
      points.x[i] = p.x() + noise * normal(random);
      points.y[i] = p.y() + noise * normal(random);
      points.z[i] = p.z() + noise * normal(random);
    }
    const Pose map_from_body = hall_from_map.inverse() * hall_from_body;
    archive.add(utime, map_from_body, 8, points);
    const auto id = static_cast<std::uint32_t>(archive.keyframes().size());
    Constraint constraint;
    constraint.to = id;
    constraint.from_to = map_from_body;
    if (id > 1) {
      constraint.from = id - 1;
      constraint.from_to = archive.keyframes()[id - 2].map_from_body.inverse() * map_from_body;
    }
    constraint.information = Matrix6::Identity() / (0.01 * 0.01);
    map.constraints.push_back(constraint);
  }
  map.keyframes = archive.keyframes();
  return map;
}

}  // namespace

TEST_CASE("two maps of one hall are merged, in the frame of the first, in either order") {
  const Pose one = frame_in_hall(-6, 1, 0.4), other = frame_in_hall(5, -3, -2.0);
  const SavedMap a = drive(one, -6, 5, 1, 100), b = drive(other, 6, -4, -2, 900);
  for (const bool swapped : {false, true}) {
    const SavedMap &first = swapped ? b : a, &second = swapped ? a : b;
    const Pose first_from_second = swapped ? Pose(other.inverse() * one) : Pose(one.inverse() * other);
    const MapMerge merged = merge_maps(first, second, {});
    REQUIRE(merged.joined);
    CHECK(merged.agreeing >= 3);
    CHECK(merged.otherwise <= 1);
    CHECK(merged.closures >= 2);
    const std::vector<ArchivedKeyframe>& keyframes = merged.map.keyframes;
    REQUIRE(keyframes.size() == a.keyframes.size() + b.keyframes.size());
    for (std::size_t i = 0; i < keyframes.size(); ++i) {
      CAPTURE(i);
      const bool is_first = i < first.keyframes.size();
      const Pose& before =
          (is_first ? first : second).keyframes[is_first ? i : i - first.keyframes.size()].map_from_body;
      const Pose expected = is_first ? before : Pose(first_from_second * before);
      CHECK(near(keyframes[i].map_from_body, expected, 0.03, 0.005));
    }
    // One graph: constraints connect every keyframe to the frame of the map.
    std::set<std::uint32_t> tied = {kOriginNode};
    for (std::size_t round = 0; round < keyframes.size(); ++round)
      for (const Constraint& c : merged.map.constraints)
        if (tied.count(c.from) + tied.count(c.to) == 1) tied.insert({c.from, c.to});
    CHECK(tied.size() == keyframes.size() + 1);
  }
}

TEST_CASE("maps of noisy points are merged, too") {
  const Pose one = frame_in_hall(-6, 1, 0.4), other = frame_in_hall(5, -3, -2.0);
  const SavedMap a = drive(one, -6, 5, 1, 100, 1, 0.1F), b = drive(other, 6, -4, -2, 900, 1, 0.1F);
  const MapMerge merged = merge_maps(a, b, {});
  REQUIRE(merged.joined);
  const Pose expected = one.inverse() * other * b.keyframes.back().map_from_body;
  CHECK(near(merged.map.keyframes.back().map_from_body, expected, 0.05, 0.01));
}

TEST_CASE("a map that fits at two poses in another map is not merged with it") {
  const SavedMap hall = drive(frame_in_hall(-6, 1, 0.4), -6, 5, 1, 100);
  SavedMap twice = hall;
  const SavedMap again = moved(drive(frame_in_hall(-6, 1, 0.4), -6, 5, 1, 500), at(60, 0, 0));
  const auto count = static_cast<std::uint32_t>(hall.keyframes.size());
  twice.keyframes.insert(twice.keyframes.end(), again.keyframes.begin(), again.keyframes.end());
  for (Constraint constraint : again.constraints) {
    if (constraint.from == kOriginNode)
      constraint.from_to = again.keyframes.front().map_from_body;
    else
      constraint.from += count;
    constraint.to += count;
    twice.constraints.push_back(constraint);
  }
  const SavedMap other = drive(frame_in_hall(5, -3, -2.0), 6, -4, -2, 900);
  CHECK(merge_maps(hall, other, {}).joined);
  const MapMerge merged = merge_maps(twice, other, {});
  CHECK_FALSE(merged.joined);
  CHECK(merged.agreeing >= 3);
  CHECK(merged.otherwise >= 2);
}

TEST_CASE("maps of two different halls are not merged, nor is a map without keyframes") {
  const SavedMap a = drive(frame_in_hall(-6, 1, 0.4), -6, 5, 1, 100);
  const SavedMap shorter = drive(frame_in_hall(2, -3, -2), 2, -2, -2, 900, 0.4F);
  for (const bool swapped : {false, true}) {
    const MapMerge merged = swapped ? merge_maps(shorter, a, {}) : merge_maps(a, shorter, {});
    CHECK_FALSE(merged.joined);
    CHECK(merged.searches >= 2);
    CHECK(merged.map.keyframes.empty());
  }
  CHECK_FALSE(merge_maps(a, {}, {}).joined);
  CHECK_FALSE(merge_maps({}, a, {}).joined);
}

}  // namespace scanlock
