// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/cloud_registration.hpp"

#include <doctest/doctest.h>

#include <stdexcept>
#include <string>

#include "geometry/angles.hpp"
#include "match_samples.hpp"
#include "scenes.hpp"

using namespace scanlock;

namespace {

CloudRegistration registered(const PointCloud& source, const PointCloud& target) {
  return register_raw_clouds(source, target, Eigen::Vector3d::UnitZ(), {}, {});
}

/// A tube of square section along x: every shift along x fits.
PointCloud corridor(unsigned sampling) {
  std::mt19937 rng(sampling);
  const auto uniform = [&](double low, double high) {
    return static_cast<float>(low + (high - low) * static_cast<double>(rng()) / 4294967295.0);
  };
  PointCloud cloud;
  for (int k = 0; k < 20000; ++k) {
    const float x = uniform(-20, 20), a = uniform(-2, 2);
    if (k % 4 == 0) cloud.push_back(x, a, -2);
    if (k % 4 == 1) cloud.push_back(x, a, 2);
    if (k % 4 == 2) cloud.push_back(x, -2, a);
    if (k % 4 == 3) cloud.push_back(x, 2, a);
  }
  return cloud;
}

/// The same tube as scanned in rings. The rings move with the sensor, so that scans from two positions are
/// equal.
PointCloud scanned_corridor(unsigned sampling) {
  std::mt19937 rng(sampling);
  const auto noise = [&] {
    return static_cast<float>(0.01 * (static_cast<double>(rng()) / 4294967295.0 - 0.5));
  };
  PointCloud cloud;
  for (int ring = -50; ring <= 80; ++ring) {
    const float x = 0.2f * static_cast<float>(ring);
    for (int k = 0; k < 400; ++k) {
      const float a = static_cast<float>(k % 100) / 25 - 2;
      const float sides[4][2] = {{a, -2}, {a, 2}, {-2, a}, {2 + 0.5f * a, a}};  // one wall is inclined
      cloud.push_back(x + noise(), sides[k / 100][0] + noise(), sides[k / 100][1] + noise());
    }
  }
  return cloud;
}

}  // namespace

TEST_CASE("two clouds of one yard have the verdict certain, at several yaws") {
  for (const double yaw : {0.3, 2.0, -2.8}) {
    const Pose truth = level_pose(yaw, 4, -3, 0.2);
    const PointCloud target = yard(1, 20), source = moved(yard(1, 21), truth.inverse());
    const CloudRegistration found = registered(source, target);
    CHECK(found.verdict == GlobalVerdict::kCertain);
    CHECK(found.solution.certified);
    CHECK(found.solution.upper_bound == found.solution.consensus);
    CHECK(angle_between(found.start, truth) < 1 * kDegree);
    CHECK((found.start.translation() - truth.translation()).norm() < 0.3);
    CHECK(angle_between(found.target_from_source, truth) < 0.2 * kDegree);
    CHECK((found.target_from_source.translation() - truth.translation()).norm() < 0.05);
    CHECK(found.fit.overlap > 0.5);
    CHECK(found.fit.contradiction < 0.05);
    CHECK_FALSE(found.why.empty());
  }
}

TEST_CASE("clouds of different yards do not have the verdict certain") {
  for (const unsigned other : {5u, 6u, 7u}) {
    const CloudRegistration found = registered(yard(other, 1), yard(1, 2));
    CHECK(found.verdict != GlobalVerdict::kCertain);
    CHECK(found.attempts == CloudRegistrationOptions{}.attempts);
    CHECK_FALSE(found.why.empty());
  }
}

TEST_CASE("a shift along a bare corridor does not have the verdict certain") {
  const Pose truth = level_pose(0, 3, 0, 0);
  const CloudRegistration found = registered(moved(corridor(1), truth.inverse()), corridor(2));
  CHECK(found.verdict != GlobalVerdict::kCertain);
}

TEST_CASE("two scans of a corridor of constant section do not have the verdict certain") {
  const CloudRegistration found = registered(scanned_corridor(31), scanned_corridor(32));
  CHECK(found.verdict != GlobalVerdict::kCertain);
}

TEST_CASE("two scans of a tunnel of constant section have the verdict ambiguous") {
  const CloudRegistration found = registered(scanned_tunnel(1), scanned_tunnel(2));
  CHECK(found.fit.overlap > 0.5);
  CHECK(found.verdict == GlobalVerdict::kAmbiguous);
}

TEST_CASE("the up direction may be any axis, but not the zero vector") {
  Pose tip = Pose::Identity();
  tip.linear() = so3_exp(Eigen::Vector3d(1.2, -0.4, 0));
  const Pose level_truth = level_pose(1, 2, 1, 0);
  const PointCloud target = moved(yard(1, 20), tip), source = moved(yard(1, 21), tip * level_truth.inverse());
  const CloudRegistration found =
      register_raw_clouds(source, target, 3.0 * tip.linear() * Eigen::Vector3d::UnitZ(), {}, {});
  const Pose truth = tip * level_truth * tip.inverse();
  CHECK(found.verdict == GlobalVerdict::kCertain);
  CHECK(angle_between(found.target_from_source, truth) < 0.2 * kDegree);
  CHECK((found.target_from_source.translation() - truth.translation()).norm() < 0.05);
  CHECK_THROWS_AS(register_raw_clouds(source, target, Eigen::Vector3d::Zero(), {}, {}),
                  std::invalid_argument);
}

TEST_CASE("the same clouds give the same answer") {
  const PointCloud target = yard(3, 1), source = moved(yard(3, 2), level_pose(1, 1, 1, 0));
  const CloudRegistration a = registered(source, target), b = registered(source, target);
  CHECK(a.target_from_source.matrix() == b.target_from_source.matrix());
  CHECK(a.solution.inliers == b.solution.inliers);
  CHECK(a.why == b.why);
}

TEST_CASE("each of three equal yards in a map gives a hypothesis") {
  const PointCloud seen = yard(5, 6);
  const std::vector<Pose> places = {level_pose(0.3, -70, 0, 0), level_pose(2, 0, 0, 0),
                                    level_pose(-1, 70, 0, 0)};
  PointCloud map;
  for (const Pose& place : places) {
    const PointCloud copy = moved(yard(5, 7), place);
    for (std::size_t i = 0; i < copy.size(); ++i) map.push_back(copy.point(i));
  }
  DescriptionOptions description;
  description.voxel = 0.5;
  CloudRegistrationOptions options;
  options.judged = false;
  options.tilt = 0.01;
  options.proposals = {level_pose(0.31, -70.2, 0.1, 0),
                       level_pose(0.3, -35, 0, 0)};  // one nearly correct, one wrong
  const CloudRegistration found =
      register_clouds(describe(seen, description), describe(map, description), options);
  REQUIRE(found.uncontradicted.size() == 1);
  CHECK(near(found.uncontradicted[0].refined, places[0], 0.1, 0.01));
  std::vector<Pose> proposed = found.runners_up;
  proposed.push_back(found.target_from_source);
  for (const Pose& place : places) {
    CHECK(std::count_if(proposed.begin(), proposed.end(),
                        [&](const Pose& pose) { return near(pose, place, 0.3, 0.02); }) == 1);
  }
}

TEST_CASE("the log odds of a pose are above 9 in the map of its yard, and below 4 in maps of other yards") {
  DescriptionOptions description;
  description.voxel = 0.5;
  CloudRegistrationOptions options;
  options.judged = false;
  options.tilt = 0.01;
  const CloudDescription seen = describe(yard(5, 6), description);
  const Pose there = level_pose(0.3, -70, 0, 0);
  const CloudRegistration found =
      register_clouds(seen, describe(moved(yard(5, 7), there), description), options);
  CHECK(near(found.target_from_source, there, 0.1, 0.01));
  CHECK(found.fit.steep > 1000);
  CHECK(found.log_odds > 9);
  for (const std::uint32_t strange : {1u, 2u, 3u})
    CHECK(register_clouds(seen, describe(yard(strange, 7), description), options).log_odds < 4);
}

TEST_CASE("moved objects lower the odds of the right pose little, unless another pose fits nearly as well") {
  // Five boards in a ring, which occlude the points behind them.
  const auto with_boards = [](const PointCloud& cloud, double turn) {
    PointCloud result;
    const auto bearing = [&](int board) { return turn + kPi / 2.5 * board; };
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Eigen::Vector3f p = cloud.point(i);
      bool hidden = false;
      for (int board = 0; board < 5; ++board) {
        const Eigen::Vector3f q =
            Eigen::AngleAxisf(static_cast<float>(-bearing(board)), Eigen::Vector3f::UnitZ()) * p;
        hidden = hidden || (q.x() > 9 && std::abs(q.y() * 9 / q.x()) < 2 && q.z() * 9 / q.x() < 0.6f);
      }
      if (!hidden) result.push_back(p);
    }
    for (int board = 0; board < 5; ++board) {
      for (int k = 0; k < 2080; ++k) {
        const Eigen::Vector3d p(9, 0.1 * (k % 40) - 2, 0.05 * (k / 40) - 2);
        result.push_back((Eigen::AngleAxisd(bearing(board), Eigen::Vector3d::UnitZ()) * p).cast<float>());
      }
    }
    result.viewpoints.resize(result.size(), Eigen::Vector3f::Zero());
    return result;
  };
  DescriptionOptions description;
  description.voxel = 0.5;
  CloudRegistrationOptions options;
  options.judged = false;
  options.tilt = 0.01;
  const CloudDescription seen = describe(with_boards(yard(5, 6), 0), description);
  const PointCloud place = with_boards(yard(5, 7), kPi / 5);
  const CloudRegistration alone = register_clouds(seen, describe(place, description), options);
  CHECK(alone.fit.contradiction > 0.03);
  CHECK(alone.log_odds > -1);
  CHECK(near(alone.target_from_source, Pose::Identity(), 0.1, 0.01));

  PointCloud twins = place;
  const PointCloud other = moved(place, level_pose(1, 80, 0, 0));
  for (std::size_t i = 0; i < other.size(); ++i) twins.push_back(other.point(i));
  twins.viewpoints.insert(twins.viewpoints.end(), other.viewpoints.begin(), other.viewpoints.end());
  const CloudRegistration twice = register_clouds(seen, describe(twins, description), options);
  CHECK(twice.fit.contradiction > 0.03);
  CHECK(twice.log_odds < -5);
  CHECK(twice.verdict == GlobalVerdict::kNoOverlap);
  CHECK(twice.why.find("contradict every pose") != std::string::npos);
}

TEST_CASE("the reason for too few matches counts all matches, and states where it is not proven") {
  DescriptionOptions description;
  description.voxel = 0.5;
  description.keypoints = 60;
  const CloudDescription a = describe(yard(1, 2), description), b = describe(yard(5, 3), description);
  CloudRegistrationOptions options;
  options.judged = false;
  options.target_ups = {Eigen::Vector3d::UnitZ(), Eigen::Vector3d(0.1, 0, 1).normalized()};
  const CloudRegistration proven = register_clouds(a, b, options);
  REQUIRE(proven.solution.consensus == 0);
  CHECK(proven.solution.matches > 50);
  CHECK(proven.why == "no pose has 8 of " + std::to_string(proven.solution.matches) + " matches");
  options.max_nodes = 1;
  const CloudRegistration ended = register_clouds(a, b, options);
  REQUIRE(ended.solution.consensus == 0);
  CHECK(ended.why.find("not proven") != std::string::npos);
}

TEST_CASE("empty clouds have no overlap, and clouds of different voxel sizes are refused") {
  CHECK(registered(PointCloud{}, PointCloud{}).verdict == GlobalVerdict::kNoOverlap);
  CHECK(registered(yard(1, 1), PointCloud{}).verdict == GlobalVerdict::kNoOverlap);
  CHECK(registered(PointCloud{}, yard(1, 1)).target_from_source.matrix().allFinite());
  DescriptionOptions fine, coarse;
  fine.voxel = 0.5;
  coarse.voxel = 1;
  const PointCloud cloud = yard(1, 1);
  CHECK_THROWS_AS(register_clouds(describe(cloud, fine), describe(cloud, coarse)), std::invalid_argument);
}
