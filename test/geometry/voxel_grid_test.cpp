// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "geometry/voxel_grid.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <tuple>

namespace scanlock {
namespace {

PointCloud random_cloud(std::size_t n, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> uniform(-5.0f, 5.0f);
  scanlock::PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    cloud.push_back(uniform(rng), uniform(rng), uniform(rng));
    cloud.time.push_back(static_cast<float>(i));
  }
  return cloud;
}

}  // namespace

TEST_CASE("thinning keeps one point for each voxel that has any") {
  const PointCloud cloud = random_cloud(20000, 1);
  std::set<std::tuple<int, int, int>> occupied;
  const auto voxel_of = [&](std::size_t i) {
    return std::make_tuple(static_cast<int>(std::floor(cloud.x[i] / 0.5f)),
                           static_cast<int>(std::floor(cloud.y[i] / 0.5f)),
                           static_cast<int>(std::floor(cloud.z[i] / 0.5f)));
  };
  for (std::size_t i = 0; i < cloud.size(); ++i) occupied.insert(voxel_of(i));
  std::set<std::tuple<int, int, int>> kept;
  for (std::uint32_t i : thin_by_voxel(cloud, 0.5f)) CHECK(kept.insert(voxel_of(i)).second);
  CHECK(kept == occupied);
}

TEST_CASE("thinning does not depend on the order of the points") {
  const PointCloud cloud = random_cloud(5000, 2);
  std::vector<std::uint32_t> order(cloud.size());
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  const PointCloud shuffled = select(cloud, order);
  const PointCloud a = select(cloud, thin_by_voxel(cloud, 0.7f));
  const PointCloud b = select(shuffled, thin_by_voxel(shuffled, 0.7f));
  CHECK(a.x == b.x);
  CHECK(a.y == b.y);
  CHECK(a.z == b.z);
  CHECK(a.time == b.time);
}

TEST_CASE("a cloud that is thinned while it is gathered equals the cloud thinned at the end") {
  const PointCloud cloud = random_cloud(1200000, 4);
  ThinnedCloud gathered(0.1f);
  std::size_t greatest = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    gathered.points().push_back(cloud.point(i));
    gathered.points().time.push_back(cloud.time[i]);
    if (i % 1000 != 0) continue;
    gathered.settle();
    greatest = std::max(greatest, gathered.points().size());
  }
  const PointCloud a = gathered.take(), b = select(cloud, thin_by_voxel(cloud, 0.1f));
  CHECK(a.x == b.x);
  CHECK(a.time == b.time);
  CHECK(greatest < cloud.size());
}

TEST_CASE("thinning drops points that are not finite or outside the range of the voxels") {
  scanlock::PointCloud cloud;
  cloud.push_back(std::numeric_limits<float>::quiet_NaN(), 0, 0);
  cloud.push_back(0, std::numeric_limits<float>::infinity(), 0);
  cloud.push_back(0, 0, 1e30f);
  cloud.push_back(1, 2, 3);
  const std::vector<std::uint32_t> kept = thin_by_voxel(cloud, 0.1f);
  REQUIRE(kept.size() == 1);
  CHECK(kept[0] == 3);
  CHECK(thin_by_voxel(PointCloud{}, 0.1f).empty());
  CHECK_THROWS(thin_by_voxel(cloud, 0.0f));
}

}  // namespace scanlock

TEST_CASE("averages by voxel are means of points and of normals whatever their sign") {
  scanlock::PointCloud cloud;
  cloud.push_back(0.1f, 0.2f, 0.3f);
  cloud.push_back(0.3f, 0.4f, 0.5f);
  cloud.push_back(5.5f, 0, 0);
  cloud.push_back(NAN, 0, 0);
  cloud.nx = {0, 0, NAN, 1};
  cloud.ny = {0, 0, 0, 0};
  cloud.nz = {1, -1, 0, 0};
  const scanlock::PointCloud mean = scanlock::average_by_voxel(cloud, 1.0f);
  REQUIRE(mean.size() == 2);
  const std::size_t at = mean.x[0] < 1 ? 0 : 1;
  CHECK(mean.x[at] == doctest::Approx(0.2));
  CHECK(mean.y[at] == doctest::Approx(0.3));
  CHECK(mean.z[at] == doctest::Approx(0.4));
  CHECK(std::abs(mean.nz[at]) == doctest::Approx(1));
  CHECK(mean.x[1 - at] == 5.5f);
  CHECK(mean.normal(1 - at) == Eigen::Vector3f::Zero());
  CHECK_THROWS(scanlock::average_by_voxel(cloud, 0.0f));
}

TEST_CASE("a Morton key gives its cell back, over all 21 bits") {
  std::mt19937 rng(5);
  std::uniform_int_distribution<int> any(-(1 << 20), (1 << 20) - 1);
  for (int trial = 0; trial < 1000; ++trial) {
    const Eigen::Vector3i cell(any(rng), any(rng), any(rng));
    CHECK(scanlock::morton_cell(scanlock::morton_key(cell.x(), cell.y(), cell.z())) == cell);
  }
  CHECK(scanlock::morton_cell(scanlock::morton_key(-(1 << 20), (1 << 20) - 1, 0)) ==
        Eigen::Vector3i(-(1 << 20), (1 << 20) - 1, 0));
}
