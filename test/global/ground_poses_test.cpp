// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/ground_poses.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
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
    cloud.viewpoints.push_back(kStand.cast<float>());
  };
  for (int i = 0; i < 60; ++i) add({5, 0.2f * static_cast<float>(i) - 6, 1}, {-1, 0, 0});
  for (int i = 0; i < 25; ++i) add({0.2f * static_cast<float>(i), 6, 1}, {0, -1, 0});
  return cloud;
}

std::vector<Pose> poses_of(const PointCloud& source, const PointCloud& target,
                           const std::vector<Eigen::Vector3d>& ups = {}) {
  const GroundPoses body_ups =
      ground_poses(source, target, SeenSpace(target, static_cast<float>(kVoxel)), kVoxel, ups);
  std::vector<Pose> poses;
  for (const Eigen::Matrix3d& attitude : body_ups.attitudes) {
    for (const Eigen::Vector3d& place : body_ups.places) {
      Pose pose = Pose::Identity();
      pose.linear() = attitude;
      pose.translation() = place;
      poses.push_back(pose);
    }
  }
  CHECK(poses.size() == body_ups.size());
  return poses;
}

/// The corner of a room 6 m deep, its floor 1.2 m below the eye, and another floor 3 m above that.
PointCloud two_storeys() {
  PointCloud cloud = corner();
  const PointCloud walls = cloud;
  for (int storey = 0; storey < 2; ++storey) {
    const Eigen::Vector3f eye =
        kStand.cast<float>() + 3.0f * static_cast<float>(storey) * Eigen::Vector3f::UnitZ();
    for (std::size_t i = 0; storey == 1 && i < walls.size(); ++i) {
      cloud.push_back(walls.point(i) + Eigen::Vector3f(0, 0, 3));
      cloud.nx.push_back(walls.nx[i]);
      cloud.ny.push_back(walls.ny[i]);
      cloud.nz.push_back(walls.nz[i]);
      cloud.viewpoints.push_back(eye);
    }
    for (int i = 0; i < 25; ++i) {
      for (int j = 0; j < 60; ++j) {
        cloud.push_back({0.2f * static_cast<float>(i), 0.2f * static_cast<float>(j) - 6, eye.z() - 1.2f});
        cloud.nx.push_back(0);
        cloud.ny.push_back(0);
        cloud.nz.push_back(1);
        cloud.viewpoints.push_back(eye);
      }
    }
  }
  return cloud;
}

}  // namespace

TEST_CASE("poses are at the viewpoints of the map, with yaws that align the surfaces") {
  const PointCloud target = corner();
  for (const double yaw : {0.0, 1.0, -2.5}) {
    CAPTURE(yaw);
    Pose truth = Pose::Identity();
    truth.linear() = so3_exp(Eigen::Vector3d(0, 0, yaw));
    truth.translation() = kStand + Eigen::Vector3d(0.3, -0.2, 0);
    const std::vector<Pose> poses = poses_of(moved(target, truth.inverse()), target);
    CHECK(poses.size() < 100);
    CHECK(std::any_of(poses.begin(), poses.end(), [&](const Pose& pose) {
      return near(pose, truth, 2 * kVoxel * std::sqrt(0.5) + 1e-6, 0.06);
    }));
    for (const Pose& pose : poses) CHECK((pose.linear().col(2) - Eigen::Vector3d::UnitZ()).norm() < 1e-12);
  }
}

TEST_CASE("among trunks, whose normals have all directions, poses have every heading") {
  PointCloud wood;
  for (int trunk = 0; trunk < 12; ++trunk) {
    const Eigen::Vector3f foot(static_cast<float>(trunk % 4) * 3.1f, static_cast<float>(trunk / 4) * 3.7f, 1);
    for (int k = 0; k < 144; ++k) {
      const float turn = static_cast<float>(k) * static_cast<float>(2 * kPi) / 144;
      const Eigen::Vector3f normal(std::cos(turn), std::sin(turn), 0);
      wood.push_back(foot + 0.2f * normal);
      wood.nx.push_back(normal.x());
      wood.ny.push_back(normal.y());
      wood.nz.push_back(0);
      wood.viewpoints.push_back(kStand.cast<float>());
    }
  }
  for (const double yaw : {0.3, 1.4, -2.2}) {
    CAPTURE(yaw);
    Pose truth = Pose::Identity();
    truth.linear() = so3_exp(Eigen::Vector3d(0, 0, yaw));
    truth.translation() = kStand;
    const std::vector<Pose> poses = poses_of(moved(wood, truth.inverse()), wood);
    CHECK(std::any_of(poses.begin(), poses.end(), [&](const Pose& pose) {
      return near(pose, truth, 2 * kVoxel * std::sqrt(0.5) + 1e-6, 0.06);
    }));
  }
}

TEST_CASE("with the attitudes of level ground and of a slope, half of the poses have that of the slope") {
  const PointCloud target = corner();
  const Eigen::Vector3d up = Eigen::Vector3d(0.1, 0.2, 1).normalized();
  const std::vector<Pose> poses = poses_of(target, target, {Eigen::Vector3d::UnitZ(), up});
  REQUIRE(!poses.empty());
  CHECK(poses.size() % 2 == 0);
  const auto on_slope = std::count_if(poses.begin(), poses.end(), [&](const Pose& pose) {
    return (pose.linear().col(2) - up).norm() < 1e-9;
  });
  CHECK(2 * on_slope == static_cast<std::ptrdiff_t>(poses.size()));
}

TEST_CASE("a scan with a floor gives poses at its height above every floor, also far from viewpoints") {
  const PointCloud target = two_storeys();
  const Eigen::Vector3d floor = kStand - 1.2 * Eigen::Vector3d::UnitZ();
  for (const double storey : {0.0, 3.0}) {
    CAPTURE(storey);
    Pose truth = Pose::Identity();
    truth.linear() = so3_exp(Eigen::Vector3d(0, 0, 0.6));
    // Low above its floor, and 2.9 m from the eye.
    truth.translation() = floor + Eigen::Vector3d(1.6, -2.4, 0.5 + storey);
    const PointCloud source = moved(corner(), truth.inverse());
    PointCloud with_floor = moved(target, truth.inverse());
    const std::vector<Pose> poses = poses_of(with_floor, target);
    const auto is_there = [&](const Pose& pose) {
      return near(pose, truth, 2 * kVoxel * std::sqrt(0.5) + 1e-6, 0.06) &&
             std::abs(pose.translation().z() - truth.translation().z()) < 1e-3;
    };
    CHECK(std::any_of(poses.begin(), poses.end(), is_there));
    // Without a floor in the source the heights of the map's sensors are used.
    const std::vector<Pose> without = poses_of(source, target);
    CHECK(std::none_of(without.begin(), without.end(), is_there));
    CHECK(!without.empty());
  }
}

TEST_CASE("clouds without steep surfaces or viewpoints give no poses") {
  PointCloud level = corner();
  std::fill(level.nx.begin(), level.nx.end(), 0.0f);
  std::fill(level.ny.begin(), level.ny.end(), 0.0f);
  std::fill(level.nz.begin(), level.nz.end(), 1.0f);
  CHECK(poses_of(level, corner()).empty());
  PointCloud blind = corner();
  blind.viewpoints.clear();
  CHECK(poses_of(corner(), blind).empty());
}

TEST_CASE("the number of poses is limited for many body-up attitudes") {
  PointCloud target = corner();
  for (int k = 0; k < 4000; ++k) {  // visible from all positions
    target.push_back({5, 0, 1});
    target.nx.push_back(-1);
    target.ny.push_back(0);
    target.nz.push_back(0);
    target.viewpoints.push_back({0.5f * static_cast<float>(k % 80), 0.5f * static_cast<float>(k / 80), 0});
  }
  std::vector<Eigen::Vector3d> ups;
  for (int k = 0; k < 100; ++k) ups.push_back(Eigen::Vector3d(0.01 * k, 0.02, 1).normalized());
  const std::size_t few = poses_of(target, target, {ups.front()}).size();
  CHECK(few > 1000);
  CHECK(poses_of(target, target, ups).size() <= 40000);
}

}  // namespace scanlock
