// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/cloud_check.hpp"

#include <doctest/doctest.h>

#include "global/cloud_normals.hpp"

namespace scanlock {
namespace {

constexpr float kSpacing = 0.2f;

/// Adds an upright wall from one corner to the other, 2.4 m high about the height of the sensor at `eye`.
void add_wall(const Eigen::Vector2f& from, const Eigen::Vector2f& to, const Eigen::Vector3f& eye,
              PointCloud* cloud) {
  const int steps = static_cast<int>((to - from).norm() / kSpacing);
  for (int k = 0; k <= steps; ++k) {
    const Eigen::Vector2f p = from + (to - from) * (static_cast<float>(k) / static_cast<float>(steps));
    for (float z = -1.2f; z < 1.3f; z += kSpacing) {
      cloud->push_back(p.x(), p.y(), z);
      cloud->viewpoints.push_back(eye);
    }
  }
}

/// A room of 8 m by 6 m; half_room() is 4 m long and ends with a wall across.
PointCloud half_room(const Eigen::Vector3f& eye) {
  PointCloud cloud;
  add_wall({0, -3}, {4, -3}, eye, &cloud);
  add_wall({4, -3}, {4, 3}, eye, &cloud);
  add_wall({4, 3}, {0, 3}, eye, &cloud);
  add_wall({0, 3}, {0, -3}, eye, &cloud);
  return cloud;
}

PointCloud room(const Eigen::Vector3f& eye) {
  PointCloud cloud;
  add_wall({-4, -3}, {4, -3}, eye, &cloud);
  add_wall({4, -3}, {4, 3}, eye, &cloud);
  add_wall({4, 3}, {-4, 3}, eye, &cloud);
  add_wall({-4, 3}, {-4, -3}, eye, &cloud);
  return cloud;
}

CloudFit fit(PointCloud source, PointCloud target, ContradictionOf whose = ContradictionOf::kWorse) {
  add_normals(&source, 2.5f * kSpacing);
  add_normals(&target, 2.5f * kSpacing);
  const CloudCheck s(source, static_cast<double>(kSpacing)), t(target, static_cast<double>(kSpacing));
  return compare(s, t, Pose::Identity(), whose);
}

}  // namespace

TEST_CASE("a wall that rays of the other cloud passed through is a contradiction") {
  const Eigen::Vector3f left(-2, 0, 0), right(2, 0, 0);
  const CloudFit same = fit(room(left), room(right));
  CHECK(same.overlap > 0.95);
  CHECK(same.contradiction == 0);
  CHECK(fit(half_room(right), room(left)).contradiction > 0.1);
  CHECK(fit(room(left), half_room(right)).contradiction > 0.1);
  const CloudFit new_wall = fit(half_room(right), room(left), ContradictionOf::kSource);
  CHECK(new_wall.contradiction > 0.1);
  CHECK(new_wall.missing == 0);
  const CloudFit no_wall = fit(room(left), half_room(right), ContradictionOf::kSource);
  CHECK(no_wall.contradiction == 0);
  CHECK(no_wall.missing > 0.1);
}

TEST_CASE("points in the free space of their own cloud have moved, and are no contradiction") {
  const Eigen::Vector3f left(-2, 0, 0), right(2, 0, 0);
  const PointCloud before = half_room(right), after = room(left);  // a person stood in front of the sensor
  PointCloud both = before;
  for (std::size_t i = 0; i < after.size(); ++i) {
    both.push_back(after.point(i));
    both.viewpoints.push_back(left);
  }
  CHECK(fit(before, after).contradiction > 0.1);
  CHECK(fit(both, after).contradiction < 0.01);
  CHECK(fit(after, both).contradiction < 0.01);
}

TEST_CASE("points above the known part of a column of the other cloud do not count as missing") {
  const Eigen::Vector3f left(-2, 0, 0), right(2, 0, 0);
  const PointCloud tall = room(left);
  PointCloud low, beside;
  for (std::size_t i = 0; i < tall.size(); ++i) {
    PointCloud& part = tall.z[i] < -0.1f ? low : beside;
    part.push_back(tall.point(i));
    part.viewpoints.push_back(right);
  }
  CHECK(fit(tall, low).overlap > 0.95);
  // The missing points are between the top of a cell and the top of the wall.
  CHECK(fit(tall, low).least_overlap > 0.8);
  // Points in columns where the other cloud has nothing count.
  CHECK(fit(room(left), half_room(right)).least_overlap < 0.75);
  // The overlap is low where only few points are left to compare.
  CHECK(fit(beside, low).least_overlap < 0.3);
}

TEST_CASE("the coarse fit separates the right attitude from one that is off by 0.7 rad") {
  const Eigen::Vector3f left(-2, 0, 0), right(2, 0, 0);
  PointCloud source = room(left), target = room(right);
  add_normals(&source, 2.5f * kSpacing);
  add_normals(&target, 2.5f * kSpacing);
  const CloudCheck s(source, static_cast<double>(kSpacing)), t(target, static_cast<double>(kSpacing));
  CHECK(coarse_fit(s, t, Pose::Identity(), 200).overlap > 0.95);
  CHECK(coarse_fit(s, t, Pose::Identity(), 200).contradiction == 0);
  Pose turned = Pose::Identity();
  turned.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  CHECK(coarse_fit(s, t, turned, 200).overlap < 0.6);
  CHECK(coarse_fit(s, t, turned, 200).contradiction > 0.1);
}

TEST_CASE("a fit with an empty cloud has no overlap") {
  PointCloud nothing = room({0, 0, 0}), empty;
  add_normals(&nothing, 0.5f);
  const CloudCheck some(nothing, 0.2), none(empty, 0.2);
  CHECK(compare(some, none, Pose::Identity(), ContradictionOf::kWorse).overlap == 0);
  CHECK(coarse_fit(none, some, Pose::Identity(), 10).overlap == 0);
}

}  // namespace scanlock
