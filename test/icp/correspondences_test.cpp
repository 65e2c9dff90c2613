// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/correspondences.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

#include "cloud_samples.hpp"
#include "geometry/rigid.hpp"

using namespace scanlock;
using scanlock::test::Random;

namespace {

/// Points on a few walls, some twice.
PointCloud walls(Random& random, std::size_t n) {
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    Eigen::Vector3d p = 3.0 * random.vector();
    p[static_cast<int>(i % 3)] = 4.0;
    cloud.push_back(p.cast<float>());
    if (i % 50 == 0) cloud.push_back(p.cast<float>());
  }
  return cloud;
}

/// The squared distance of the answer, so that two points at equal distances count as the same answer.
float distance_to(const PointCloud& target, std::int32_t index, const Eigen::Vector3f& p) {
  const Eigen::Vector3f d = target.point(static_cast<std::size_t>(index)) - p;
  return d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
}

}  // namespace

TEST_CASE("saved searches give the correspondences of a search for every point at every update") {
  std::int64_t saved = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    Random random(seed);
    const PointCloud target = walls(random, 2000), source = walls(random, 500);
    KdForest tree;
    tree.rebuild(target);
    Correspondences kept;
    kept.reset(target, tree, source.size());
    Pose pose = Pose::Identity();
    for (int update = 0; update < 40; ++update) {
      Vector6 step;
      step << random.vector(), random.vector();
      // Large steps first, then small ones; in every seventh update none.
      pose = se3_exp((update % 7 == 0 ? 0.0 : 0.3 * std::pow(0.8, update)) * step) * pose;
      const float gates[] = {0.2f, 1.0f, 100.0f, 0.5f};
      const float gate = gates[(update / 5) % 4];
      std::vector<float> x, y, z;
      for (std::size_t i = 0; i < source.size(); ++i) {
        const Eigen::Vector3f p = (pose * source.point(i).cast<double>()).cast<float>();
        x.push_back(p.x());
        y.push_back(p.y());
        z.push_back(p.z());
      }
      kept.update(x, y, z, gate, 1 + update % 2);
      Correspondences fresh;
      fresh.reset(target, tree, source.size());
      fresh.update(x, y, z, gate, 1);
      for (std::size_t i = 0; i < source.size(); ++i) {
        const Eigen::Vector3f p(x[i], y[i], z[i]);
        Neighbour plain;
        const bool near = tree.k_nearest(p, 1, &plain, gate) == 1;
        // Within the gate all three return a point at the smallest distance.
        for (const Correspondences* answers : {&kept, &fresh}) {
          const std::int32_t index = answers->indices()[i];
          if (near) {
            REQUIRE(index >= 0);
            CHECK(distance_to(target, index, p) == plain.squared_distance);
          } else if (index >= 0) {
            CHECK(distance_to(target, index, p) >= gate * gate);
          }
        }
        if (near && kept.indices()[i] != fresh.indices()[i])
          CHECK(target.point(static_cast<std::size_t>(kept.indices()[i])) ==
                target.point(static_cast<std::size_t>(fresh.indices()[i])));
      }
    }
    saved += kept.searches_saved();
    CHECK(kept.searches_made() + kept.searches_saved() == static_cast<std::int64_t>(40 * source.size()));
  }
  CHECK(saved > 6 * 40 * 500 / 5);
}

TEST_CASE("an empty target has no neighbours") {
  const PointCloud target;
  KdForest tree;
  tree.rebuild(target);
  Correspondences correspondences;
  correspondences.reset(target, tree, 1);
  correspondences.update({0.f}, {0.f}, {0.f}, 10.0f, 1);
  CHECK(correspondences.indices() == std::vector<std::int32_t>{-1});
}
