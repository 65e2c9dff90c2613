// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "search/kd_tree.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "geometry/parallel.hpp"

namespace scanlock {
namespace {

PointCloud random_cloud(std::size_t n, unsigned seed, float extent) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> uniform(-extent, extent);
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) cloud.push_back(uniform(rng), uniform(rng), uniform(rng));
  return cloud;
}

std::vector<Neighbour> brute_force(const PointCloud& cloud, const Eigen::Vector3f& query, std::size_t k) {
  std::vector<Neighbour> all;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.point(i).allFinite()) continue;
    const float dx = query.x() - cloud.x[i], dy = query.y() - cloud.y[i], dz = query.z() - cloud.z[i];
    all.push_back({static_cast<std::int32_t>(i), dx * dx + dy * dy + dz * dz});
  }
  std::sort(all.begin(), all.end(),
            [](const Neighbour& a, const Neighbour& b) { return a.squared_distance < b.squared_distance; });
  all.resize(std::min(k, all.size()));
  return all;
}

}  // namespace

TEST_CASE("the tree gives the neighbours of brute force") {
  const PointCloud cloud = random_cloud(3000, 1, 10.0f);
  const PointCloud queries = random_cloud(500, 2, 14.0f);
  const KdTree tree(cloud);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    Neighbour found[8];
    REQUIRE(tree.k_nearest(queries.point(i), 8, found) == 8);
    const std::vector<Neighbour> expected = brute_force(cloud, queries.point(i), 8);
    for (std::size_t k = 0; k < 8; ++k) CHECK(found[k].squared_distance == expected[k].squared_distance);
    CHECK(tree.nearest(queries.point(i)).index == expected[0].index);
  }
}

TEST_CASE("a distance bound excludes exactly the points beyond it") {
  const PointCloud cloud = random_cloud(2000, 3, 10.0f);
  const PointCloud queries = random_cloud(300, 4, 12.0f);
  const KdTree tree(cloud);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Neighbour expected = brute_force(cloud, queries.point(i), 1)[0];
    const float distance = std::sqrt(expected.squared_distance);
    CHECK(tree.nearest(queries.point(i), distance * 1.001f).index == expected.index);
    CHECK(tree.nearest(queries.point(i), distance * 0.999f).index == -1);
  }
}

TEST_CASE("empty clouds and k above n are safe") {
  const Eigen::Vector3f query(1, 2, 3);
  Neighbour found[5];
  CHECK(KdTree().nearest(query).index == -1);
  CHECK(KdTree(PointCloud{}).k_nearest(query, 5, found) == 0);
  PointCloud one;
  one.push_back(1, 2, 4);
  CHECK(KdTree(one).k_nearest(query, 5, found) == 1);
  CHECK(found[0].index == 0);
  CHECK(KdTree(one).k_nearest(query, 0, found) == 0);
  PointCloud equal;
  for (int i = 0; i < 100; ++i) equal.push_back(1, 1, 1);
  CHECK(KdTree(equal).k_nearest(query, 5, found) == 5);
}

TEST_CASE("points and queries that are not finite are left out") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  PointCloud cloud = random_cloud(1000, 5, 5.0f);
  for (std::size_t i = 0; i < cloud.size(); i += 7) cloud.x[i] = nan;
  for (std::size_t i = 3; i < cloud.size(); i += 11) cloud.z[i] = infinity;
  const KdTree tree(cloud);
  const PointCloud queries = random_cloud(200, 6, 6.0f);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    CHECK(tree.nearest(queries.point(i)).index == brute_force(cloud, queries.point(i), 1)[0].index);
  }
  CHECK(tree.nearest({nan, 0, 0}).index == -1);
  CHECK(tree.nearest({0, infinity, 0}).index == -1);
}

TEST_CASE("answers are bit equal for any number of threads") {
  const PointCloud cloud = random_cloud(5000, 7, 20.0f);
  const PointCloud queries = random_cloud(5000, 8, 20.0f);
  const KdTree tree(cloud);
  const auto ask = [&](int threads) {
    std::vector<Neighbour> answers(queries.size());
    for_each_chunk(queries.size(), 256, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) answers[i] = tree.nearest(queries.point(i));
    });
    return answers;
  };
  const std::vector<Neighbour> one = ask(1), four = ask(4);
  for (std::size_t i = 0; i < one.size(); ++i) {
    CHECK(one[i].index == four[i].index);
    CHECK(one[i].squared_distance == four[i].squared_distance);
  }
}

}  // namespace scanlock
