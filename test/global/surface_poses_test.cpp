// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/surface_poses.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "global/cloud_description.hpp"
#include "scenes.hpp"

namespace scanlock {
namespace {

constexpr double kEpsilon = 0.4;

DescriptionOptions half_metre() {
  DescriptionOptions options;
  options.voxel = 0.5;
  return options;
}

std::vector<Pose> poses(const CloudDescription& source, const CloudDescription& target,
                        const std::vector<SurfaceMatch>& matches, const std::vector<Eigen::Vector3d>& ups,
                        std::size_t count, const GroundPoses& guesses = {}) {
  const CloudCheck s(source.points, source.voxel), t(target.points, target.voxel);
  return surface_poses(matches, guesses, s, t, ups, Eigen::Vector3d::Zero(), kEpsilon, count);
}

bool is_about(const Pose& pose, const Pose& truth) {
  return near(pose, truth, 1.0, 0.1);
}

}  // namespace

TEST_CASE("a single right match among more than a thousand is sufficient") {
  const Pose truth = level_pose(2, 3, -4, 0.5);
  const CloudDescription target = describe(yard(1, 2), half_metre());
  const CloudDescription source = describe(moved(yard(1, 3), truth.inverse()), half_metre());
  std::vector<SurfaceMatch> matches = match_surfaces(source, target, 10);
  REQUIRE(matches.size() > 1000);
  const auto right = [&](const SurfaceMatch& m) {
    return (truth * m.p - m.q).norm() < 0.3 && std::abs(m.normal_q.z()) < 0.2 &&
           (truth.linear() * m.normal_p).dot(m.normal_q) > 0.999;
  };
  const auto first = std::find_if(matches.begin(), matches.end(), right);
  REQUIRE(first != matches.end());
  const SurfaceMatch one = *first;
  matches.erase(std::remove_if(matches.begin(), matches.end(),
                               [&](const SurfaceMatch& m) { return (truth * m.p - m.q).norm() < 2; }),
                matches.end());
  const std::vector<Pose> without = poses(source, target, matches, {}, 8);
  CHECK(std::none_of(without.begin(), without.end(), [&](const Pose& p) { return is_about(p, truth); }));
  matches.push_back(one);
  const std::vector<Pose> with = poses(source, target, matches, {}, 8);
  REQUIRE(!with.empty());
  CHECK(is_about(with.front(), truth));
}

TEST_CASE("without matches, the given pose that fits the clouds is found") {
  const Pose truth = level_pose(2, 3, -4, 0.5);
  const CloudDescription target = describe(yard(1, 2), half_metre());
  const CloudDescription source = describe(moved(yard(1, 3), truth.inverse()), half_metre());
  const std::vector<Pose> found =
      poses(source, target, {}, {}, 8,
            {{level_pose(0, 0, 0, 0).linear(), level_pose(2.05, 0, 0, 0).linear()},
             {{3, -4, 0.5}, {3.3, -4.2, 0.5}, {9, 2, 0}}});
  REQUIRE(!found.empty());
  CHECK(is_about(found.front(), truth));
}

TEST_CASE("on a slope the pose has the given body-up attitude") {
  Pose slope = Pose::Identity();
  slope.linear() = Eigen::AngleAxisd(0.15, Eigen::Vector3d(1, 0.5, 0).normalized()).toRotationMatrix();
  const Pose truth = slope * level_pose(1, 2, -3, 0);
  const CloudDescription target = describe(yard(4, 2), half_metre());
  const CloudDescription source = describe(moved(yard(4, 3), truth.inverse()), half_metre());
  const std::vector<SurfaceMatch> matches = match_surfaces(source, target, 10);
  const Eigen::Vector3d up = truth.linear().col(2);
  const std::vector<Pose> found = poses(source, target, matches, {Eigen::Vector3d::UnitZ(), up}, 4);
  REQUIRE(!found.empty());
  CHECK(is_about(found.front(), truth));
  CHECK((found.front().linear().col(2) - up).norm() < 1e-9);
}

TEST_CASE("no two of the poses are near each other, and without matches there are none") {
  const CloudDescription target = describe(yard(1, 2), half_metre()),
                         source = describe(yard(1, 3), half_metre());
  const std::vector<Pose> found = poses(source, target, match_surfaces(source, target, 10), {}, 12);
  CHECK(found.size() == 12);
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) CHECK_FALSE(near(found[i], found[j], 0.5, 0.05));
  }
  CHECK(poses(source, target, {}, {}, 12).empty());
}

}  // namespace scanlock
