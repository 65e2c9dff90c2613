// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/stand_poses.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "geometry/moved_cloud.hpp"

namespace scanlock {
namespace {

constexpr double kVoxel = 0.2;
const Eigen::Vector3d kStand(1.3, -0.7, 0.4);

/// Two walls at right angles with their normals, of unequal length, seen from `kStand`.
PointCloud corner() {
  PointCloud cloud;
  const auto add = [&](const Eigen::Vector3f& p, const Eigen::Vector3f& normal) {
    cloud.push_back(p);
    cloud.nx.push_back(normal.x());
    cloud.ny.push_back(normal.y());
    cloud.nz.push_back(normal.z());
    cloud.eyes.push_back(kStand.cast<float>());
  };
  for (int i = 0; i < 60; ++i) add({5, 0.2f * static_cast<float>(i) - 6, 1}, {-1, 0, 0});
  for (int i = 0; i < 25; ++i) add({0.2f * static_cast<float>(i), 6, 1}, {0, -1, 0});
  return cloud;
}

}  // namespace

TEST_CASE("a sensor is looked for where others stood, turned as the surfaces are") {
  const PointCloud target = corner();
  for (const double yaw : {0.0, 1.0, -2.5}) {
    CAPTURE(yaw);
    Pose truth = Pose::Identity();
    truth.linear() = so3_exp(Eigen::Vector3d(0, 0, yaw));
    truth.translation() = kStand + Eigen::Vector3d(0.3, -0.2, 0);
    const std::vector<Pose> poses = stand_poses(moved(target, truth.inverse()), target, kVoxel, {});
    CHECK(poses.size() < 100);
    CHECK(std::any_of(poses.begin(), poses.end(), [&](const Pose& pose) {
      return near(pose, truth, 2 * kVoxel * std::sqrt(0.5) + 1e-6, 0.06);
    }));
    for (const Pose& pose : poses) CHECK((pose.linear().col(2) - Eigen::Vector3d::UnitZ()).norm() < 1e-12);
  }
}

TEST_CASE("a sensor that is looked for on a slope stands on it") {
  const PointCloud target = corner();
  const Eigen::Vector3d up = Eigen::Vector3d(0.1, 0.2, 1).normalized();
  const std::vector<Pose> poses = stand_poses(target, target, kVoxel, {Eigen::Vector3d::UnitZ(), up});
  REQUIRE(!poses.empty());
  CHECK(poses.size() % 2 == 0);
  const auto on_slope = std::count_if(poses.begin(), poses.end(), [&](const Pose& pose) {
    return (pose.linear().col(2) - up).norm() < 1e-9;
  });
  CHECK(2 * on_slope == static_cast<std::ptrdiff_t>(poses.size()));
}

TEST_CASE("clouds without steep surfaces or eyes give no guesses") {
  PointCloud level = corner();
  std::fill(level.nx.begin(), level.nx.end(), 0.0f);
  std::fill(level.ny.begin(), level.ny.end(), 0.0f);
  std::fill(level.nz.begin(), level.nz.end(), 1.0f);
  CHECK(stand_poses(level, corner(), kVoxel, {}).empty());
  PointCloud blind = corner();
  blind.eyes.clear();
  CHECK(stand_poses(corner(), blind, kVoxel, {}).empty());
}

TEST_CASE("of a body that stood in many ways no more poses are looked at") {
  PointCloud target = corner();
  for (int k = 0; k < 4000; ++k) {  // seen from everywhere
    target.push_back({5, 0, 1});
    target.nx.push_back(-1);
    target.ny.push_back(0);
    target.nz.push_back(0);
    target.eyes.push_back({0.5f * static_cast<float>(k % 80), 0.5f * static_cast<float>(k / 80), 0});
  }
  std::vector<Eigen::Vector3d> ups;
  for (int k = 0; k < 100; ++k) ups.push_back(Eigen::Vector3d(0.01 * k, 0.02, 1).normalized());
  const std::size_t few = stand_poses(target, target, kVoxel, {ups.front()}).size();
  CHECK(few > 1000);
  CHECK(stand_poses(target, target, kVoxel, ups).size() <= 40000);
}

}  // namespace scanlock
