// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "global/cloud_description.hpp"
#include "scenes.hpp"

using namespace scanlock;

namespace {

int right_ones(const Matches& matches, const Pose& truth, double reach) {
  return static_cast<int>(std::count_if(matches.begin(), matches.end(),
                                        [&](const Match& m) { return (truth * m.p - m.q).norm() < reach; }));
}

}  // namespace

TEST_CASE("descriptions of a yard seen twice match") {
  const Pose truth = level_pose(2.1, 3, -2, 0.4);
  const PointCloud target = yard(1, 10), source = moved(yard(1, 11), truth.inverse());
  for (const bool paper : {false, true}) {
    DescriptionOptions options = paper ? paper_description() : DescriptionOptions{};
    options.voxel = description_voxel(target);
    const CloudDescription s = describe(source, options), t = describe(target, options);
    CHECK(t.points.size() > 3000);
    CHECK(t.points.has_normals());
    CHECK(t.descriptors.cols() == (paper ? 33 : 35));
    CHECK(t.descriptors.rows() == static_cast<Eigen::Index>(t.keypoints.size()));
    const Matches matches = match(s, t, paper ? 10 : 4);
    CHECK(right_ones(matches, truth, options.voxel) >= 15);
  }
}

TEST_CASE("a description does not depend on the order of the points, nor on points that are not finite") {
  const PointCloud cloud = yard(2, 1);
  PointCloud shuffled;
  for (std::size_t i = 0; i < cloud.size(); ++i) shuffled.push_back(cloud.point(i * 7919 % cloud.size()));
  shuffled.push_back(std::numeric_limits<float>::quiet_NaN(), 0, 0);
  const CloudDescription a = describe(cloud), b = describe(shuffled);
  CHECK(a.voxel == b.voxel);
  CHECK(a.keypoints == b.keypoints);
  CHECK(a.descriptors == b.descriptors);
}

TEST_CASE("clouds without features have no keypoints") {
  CHECK(description_voxel(PointCloud{}) == 0);
  CHECK(describe(PointCloud{}).keypoints.empty());
  PointCloud same;
  for (int i = 0; i < 100; ++i) same.push_back(1, 2, 3);
  CHECK(describe(same).keypoints.empty());
  CHECK(match(describe(same), describe(yard(1, 1))).empty());
  DescriptionOptions wrong;
  wrong.feature_radius = 0;
  CHECK_THROWS_AS(describe(same, wrong), std::invalid_argument);
}
