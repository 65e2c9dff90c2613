// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/occupancy_grid.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

namespace scanlock {
namespace {

void add_ray(PointCloud* cloud, const Eigen::Vector2f& from, const Eigen::Vector2f& to) {
  cloud->push_back(to.x(), to.y(), 0);
  cloud->viewpoints.push_back({from.x(), from.y(), 0});
}

OccupancyGrid::State at(const OccupancyGrid& grid, float x, float y) {
  const auto cell = [&](float v) {
    return static_cast<int>(std::floor(v / static_cast<float>(grid.cell())));
  };
  return grid.state(cell(x) - grid.low().x(), cell(y) - grid.low().y());
}

}  // namespace

TEST_CASE("a ray ends on a surface, passes through free space, and tells nothing of other cells") {
  PointCloud cloud;
  add_ray(&cloud, {-1, 0.55f}, {2.05f, 0.55f});
  add_ray(&cloud, {-1, 0.55f}, {-1, 2.05f});
  const OccupancyGrid grid(cloud, 0.1);
  CHECK(at(grid, 2.05f, 0.55f) == OccupancyGrid::kOccupied);
  CHECK(at(grid, -1, 2.05f) == OccupancyGrid::kOccupied);
  for (const float x : {-0.95f, 0.05f, 1.75f}) CHECK(at(grid, x, 0.55f) == OccupancyGrid::kFree);
  CHECK(at(grid, 1.95f, 0.55f) == OccupancyGrid::kUnknown);  // the ray may graze the surface there
  CHECK(at(grid, 1, 1.55f) == OccupancyGrid::kUnknown);
}

TEST_CASE("an object that most scans saw through is gone, and rays of one scan count once") {
  for (const int through : {1, 3}) {
    CAPTURE(through);
    PointCloud cloud;
    for (int beam = 0; beam < 5; ++beam) add_ray(&cloud, {0, 0.05f}, {1.05f, 0.05f});
    for (int scan = 0; scan < through; ++scan)
      for (int beam = 0; beam < 20; ++beam)
        add_ray(&cloud, {-0.1f * static_cast<float>(scan + 1), 0.05f}, {3.05f, 0.05f});
    const OccupancyGrid grid(cloud, 0.1);
    CHECK(at(grid, 1.05f, 0.05f) == (through == 1 ? OccupancyGrid::kOccupied : OccupancyGrid::kFree));
    CHECK(at(grid, 3.05f, 0.05f) == OccupancyGrid::kOccupied);
  }
}

TEST_CASE("points far away or without a place are left out, and take no memory") {
  PointCloud cloud;
  add_ray(&cloud, {0, 0}, {1.05f, 0.05f});
  add_ray(&cloud, {0, 0}, {1e30f, 0});
  add_ray(&cloud, {0, 0}, {-1e6f, 1e6f});
  add_ray(&cloud, {0, 0}, {std::numeric_limits<float>::infinity(), 0});
  const OccupancyGrid grid(cloud, 0.1);
  CHECK(grid.size().maxCoeff() <= 2 * OccupancyGrid::kMostCells + 1);
  CHECK(at(grid, 1.05f, 0.05f) == OccupancyGrid::kOccupied);
  CHECK(OccupancyGrid(PointCloud(), 0.1).size().maxCoeff() == 1);
}

}  // namespace scanlock
