// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "mapping/pose_history.hpp"

#include <doctest/doctest.h>

namespace scanlock {
namespace {

Pose at(double x, double heading) {
  Vector6 xi;
  xi << x, 0.3, 0, 0, 0, heading;
  return se3_exp(xi);
}

std::function<Pose(std::uint32_t)> in(const std::map<std::uint32_t, Pose>& map) {
  return [&map](std::uint32_t keyframe) { return map.at(keyframe); };
}

}  // namespace

TEST_CASE("published poses follow their keyframe when it moves, is replaced or is removed") {
  PoseHistory history;
  std::map<std::uint32_t, Pose> map{{1, at(1, 0.1)}, {2, at(2, 0.2)}};
  const std::uint32_t one = history.stamp(1, map[1]);
  CHECK(history.stamp(1, map[1]) == one);
  const std::uint32_t two = history.stamp(2, map[2]);
  CHECK(two != one);
  CHECK(history.correction(one, in(map)).matrix() == Pose::Identity().matrix());

  // The keyframes move: a published pose keeps its pose relative to its keyframe.
  const Pose by_one = at(0.3, 0.05), by_two = at(0.5, 0.02);
  map[1] = by_one * map[1];
  map[2] = by_two * map[2];
  CHECK(near(history.correction(one, in(map)), by_one, 1e-12, 1e-12));
  CHECK(near(history.correction(two, in(map)), by_two, 1e-12, 1e-12));
  const std::uint32_t later = history.stamp(2, map[2]);
  CHECK(later != two);
  CHECK(history.correction(later, in(map)).matrix() == Pose::Identity().matrix());

  // Keyframe 2 shows the same ground as 1 and is removed: its poses move with 1.
  history.replace(2, 1, map[1].inverse() * map[2]);
  map.erase(2);
  CHECK(near(history.correction(one, in(map)), by_one, 1e-12, 1e-12));
  CHECK(near(history.correction(two, in(map)), by_two, 1e-12, 1e-12));
  const Pose again = at(-0.2, 0.3);
  map[1] = again * map[1];
  CHECK(near(history.correction(one, in(map)), again * by_one, 1e-12, 1e-12));
  CHECK(near(history.correction(two, in(map)), again * by_two, 1e-12, 1e-12));
  CHECK(near(history.correction(later, in(map)), again, 1e-12, 1e-12));

  // Keyframe 1 is replaced by 3, and then 3 is removed.
  map[3] = at(7, 0);
  history.stamp(3, map[3]);
  history.replace(1, 3, map[3].inverse() * map[1]);
  map.erase(1);
  CHECK(near(history.correction(two, in(map)), again * by_two, 1e-12, 1e-12));
  const Pose once_more = at(0.4, -0.1);
  map[3] = once_more * map[3];
  CHECK(near(history.correction(two, in(map)), once_more * again * by_two, 1e-12, 1e-12));
  history.remove(3, map[3]);
  map.clear();
  CHECK(near(history.correction(one, in(map)), once_more * again * by_one, 1e-12, 1e-12));
  CHECK(near(history.correction(later, in(map)), once_more * again, 1e-12, 1e-12));
}

TEST_CASE("poses published while the robot was lost follow the correction found later") {
  PoseHistory history;
  std::map<std::uint32_t, Pose> map{{1, at(1, 0.1)}};
  const std::uint32_t first = history.open(1, map[1]), second = history.open(1, map[1]);
  CHECK(first != second);
  map[2] = at(5, 0.4);
  history.close(second, Pose::Identity(), 2, map[2]);
  CHECK(history.correction(second, in(map)).matrix() == Pose::Identity().matrix());
  const Pose correction = at(3, -0.2), bent = at(0.1, 0.02);
  history.close(second, correction, 2, map[2]);
  CHECK(near(history.correction(second, in(map)), correction, 1e-12, 1e-12));
  map[2] = bent * map[2];
  CHECK(near(history.correction(second, in(map)), bent * correction, 1e-12, 1e-12));
  CHECK(history.correction(first, in(map)).matrix() == Pose::Identity().matrix());
}

}  // namespace scanlock
