// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/cloud_pair.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "geometry/angles.hpp"
#include "global/attitude_search.hpp"
#include "scenes.hpp"

namespace scanlock {

TEST_CASE("refinement does not leave a right pose for a pose that only a dozen matches support") {
  constexpr double kEpsilon = 0.4;
  constexpr std::size_t kDozen = 12;
  DescriptionOptions options;
  options.voxel = 0.5;
  CloudDescription source = describe(yard(1, 2), options), target = source;
  const auto keypoint = [&](std::size_t row) {
    return Eigen::Vector3d(source.points.point(source.keypoints[row]).cast<double>());
  };
  std::vector<std::size_t> rows(source.keypoints.size());
  for (std::size_t row = 0; row < rows.size(); ++row) rows[row] = row;
  const Eigen::Vector3d middle = keypoint(rows.size() / 2);
  std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
    return (keypoint(a) - middle).norm() < (keypoint(b) - middle).norm();
  });
  REQUIRE(rows.size() > 20 * kDozen);
  REQUIRE((keypoint(rows[20 * kDozen]) - middle).norm() > 5);
  // Only the dozen points around `middle` match points near them, turned by 0.3 rad: the descriptor of each
  // is more similar to those of ten distant points than to another of the dozen.
  const auto count = static_cast<Eigen::Index>(rows.size()), dozen = static_cast<Eigen::Index>(kDozen);
  source.descriptors = target.descriptors = Descriptors::Zero(count, dozen + 2);
  source.descriptors.col(dozen).setConstant(30);
  target.descriptors.col(dozen + 1).setConstant(30);
  for (std::size_t i = 0; i < kDozen; ++i) {
    const Eigen::RowVectorXf looks = 10 * Eigen::RowVectorXf::Unit(dozen + 2, static_cast<Eigen::Index>(i));
    source.descriptors.row(static_cast<Eigen::Index>(rows[i])) = looks;
    target.descriptors.row(static_cast<Eigen::Index>(rows[i])) = looks;
    for (std::size_t k = 0; k < 10; ++k)
      source.descriptors.row(static_cast<Eigen::Index>(rows[rows.size() - 1 - 10 * i - k])) = 0.9f * looks;
    const Eigen::Vector3d turned = rotation_about_z(0.3) * (keypoint(rows[i]) - middle) + middle;
    const std::uint32_t point = target.keypoints[rows[i]];
    target.points.x[point] = static_cast<float>(turned.x());
    target.points.y[point] = static_cast<float>(turned.y());
  }
  CloudPair pair(source, target, kEpsilon, false, nullptr);
  const Matches matches = pair.matches(1);
  REQUIRE(std::count_if(matches.begin(), matches.end(),
                        [&](const Match& m) { return (m.p - m.q).norm() < 2 * kEpsilon; }) >= 8);
  const Hypothesis found = pair.examine(Pose::Identity(), 0, false);
  CHECK(pair.separation(found.start, Pose::Identity()) < 1);
  CHECK(near(found.refined, Pose::Identity(), 0.05, 0.5 * kDegree));
  CHECK(found.fit.overlap > 0.9);
}

}  // namespace scanlock
