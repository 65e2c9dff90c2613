// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/local_surfaces.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

using namespace scanlock;

namespace {

/// The half of a trunk that faces the sensor at the origin, scanned in rings.
PointCloud trunk(double radius, double ring_spacing, bool upright) {
  PointCloud cloud;
  for (int ring = -4; ring <= 4; ++ring) {
    for (double a = 2.0; a < 4.3; a += 0.5) {
      const double x = 5 + radius * std::cos(a), y = radius * std::sin(a), along = ring * ring_spacing;
      if (upright) {
        cloud.push_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(along));
      } else {
        cloud.push_back(static_cast<float>(x), static_cast<float>(along), static_cast<float>(y));
      }
    }
  }
  return cloud;
}

Surface surface_at(const PointCloud& cloud, std::int32_t index, float radius) {
  KdForest tree;
  tree.rebuild(cloud);
  LocalSurfaces surfaces;
  surfaces.reset(cloud, tree, radius);
  surfaces.prepare({index}, 1);
  return surfaces.at(index);
}

}  // namespace

TEST_CASE("an upright trunk is a line, and a lying log is not") {
  const Surface line = surface_at(trunk(0.1, 0.3, true), 22, 2);
  REQUIRE(line.line);
  CHECK(std::abs(line.normal.z()) > 0.99f);
  CHECK(line.weight > 0.3f);
  CHECK(std::abs(line.centre.x() - 5) < 0.12f);
  CHECK(std::abs(line.centre.y()) < 0.05f);
  CHECK_FALSE(surface_at(trunk(0.1, 0.3, false), 22, 2).line);
}

TEST_CASE("a few points that stand alone are a post, and its scale follows from their spread") {
  PointCloud cloud;
  const auto add = [&](float x, float y, float z) { cloud.push_back(x, y, z); };
  add(20, 0, 0);
  add(20, 0.1f, 0);
  add(20, 0.05f, 1.5f);
  for (const bool told : {true, false}) {
    cloud.alone.assign(cloud.size(), told ? 1 : 0);
    const Surface post = surface_at(cloud, 0, 2);
    CHECK(post.line == told);
    CHECK((post.weight > 0) == told);
    if (!told) continue;
    CHECK(post.normal.isApprox(Eigen::Vector3f::UnitZ()));
    CHECK(post.centre.head<2>().isApprox(Eigen::Vector2f(20, 0.05f), 1e-4f));
    CHECK(post.scale == doctest::Approx(0.05 / std::hypot(0.0408, 2 * 0.125 / 3.4641)).epsilon(0.01));
  }
  add(20, 1.8f, 0);  // beside the trunk
  cloud.alone.assign(cloud.size(), 1);
  CHECK(surface_at(cloud, 0, 2).weight == 0);
  cloud.y.back() = 0.9f;  // a bush
  const Surface bush = surface_at(cloud, 0, 2);
  CHECK(bush.line);
  CHECK(bush.scale < 0.2f);
}

TEST_CASE("the columns of a scan pattern on a wall are no trunks") {
  PointCloud wall;
  for (int column = -10; column <= 10; ++column) {
    for (int k = -40; k <= 40; ++k)
      wall.push_back(5.0f + 0.04f * static_cast<float>((k + column) % 2), 0.4f * static_cast<float>(column),
                     0.03f * static_cast<float>(k));
  }
  const Surface surface = surface_at(wall, 10 * 81 + 40, 2);
  CHECK_FALSE(surface.line);
}

TEST_CASE("a plane goes through the centre of its neighbours") {
  PointCloud floor;
  for (int i = 0; i < 100; ++i)
    floor.push_back(0.1f * static_cast<float>(i % 10), 0.1f * static_cast<float>(i / 10), -1.5f);
  const Surface surface = surface_at(floor, 55, 1);
  CHECK_FALSE(surface.line);
  CHECK(std::abs(surface.normal.z()) == doctest::Approx(1));
  CHECK(surface.centre.z() == doctest::Approx(-1.5f));
  CHECK(surface.weight > 0.5f);
}

TEST_CASE("at the foot of a wall the plane of a point of the ground goes through the ground") {
  PointCloud corner;
  for (int i = 0; i < 21; ++i) {
    for (int k = 0; k < 8; ++k) {
      const float along = 0.3f * static_cast<float>(i), away = 0.3f * static_cast<float>(k);
      corner.push_back(along, away, 0);
      corner.push_back(along, 0, away);
    }
  }
  int thick = 0;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(corner.size()); ++i) {
    const Eigen::Vector3f own = corner.point(static_cast<std::size_t>(i));
    const Surface surface = surface_at(corner, i, 2);
    if (surface.line || surface.weight <= 0 || surface.scale >= 1) continue;
    ++thick;
    CHECK(std::abs(surface.normal.dot(own - surface.centre)) < 1e-6f);
  }
  CHECK(thick > 20);
}

TEST_CASE("the scale of a plane falls in proportion to a thickness above 0.05 m") {
  for (const float thickness : {0.02f, 0.05f, 0.1f, 0.2f}) {  // standard deviation
    CAPTURE(thickness);
    PointCloud hedge;
    for (int i = 0; i < 196; ++i)
      hedge.push_back(0.1f * static_cast<float>(i % 14), i % 2 == 0 ? thickness : -thickness,
                      0.1f * static_cast<float>(i / 14));
    std::vector<Neighbour> all;
    for (std::int32_t i = 0; i < 196; ++i) all.push_back({i, 0});
    const Surface surface = fit_surface(hedge, all.data(), 196);
    CHECK(std::abs(surface.normal.y()) > 0.99f);
    CHECK(surface.scale == doctest::Approx(std::min(1.0f, 0.05f / thickness)).epsilon(0.02));
  }
}

TEST_CASE("a floor is a plane also where its rings are farther apart than the search radius") {
  // Some of 16 beams, 2 degrees apart, 1.2 m above the floor: their rings on it are at 4.5, 5.2 and 6.2 m.
  std::mt19937 rng(3);
  std::normal_distribution<float> noise(0, 0.01f);
  const auto ring = [&](PointCloud* cloud, float radius, float height) {
    for (int k = -30; k <= 30; ++k) {
      const float azimuth = 0.014f * static_cast<float>(k);
      cloud->push_back(radius * std::cos(azimuth), radius * std::sin(azimuth), height + noise(rng));
    }
  };
  constexpr int kMiddle = 30;
  PointCloud floor;
  for (const float radius : {4.5f, 5.2f, 6.2f}) ring(&floor, radius, -1.2f);
  const Surface of_rings = surface_at(floor, kMiddle, 0.42f);
  CHECK(of_rings.weight > 0.3f);
  CHECK(std::abs(of_rings.normal.z()) > 0.998f);

  // The last ring on the floor and the rings on a wall behind it do not form a plane either.
  PointCloud edge;
  ring(&edge, 4.5f, -1.2f);
  for (const float elevation : {-13.0f, -11.0f, -9.0f, -7.0f, -5.0f}) {
    const float height = 5.1f * std::tan(elevation * 0.0174533f);
    for (int k = -30; k <= 30; ++k) edge.push_back(5.1f + noise(rng), 0.071f * static_cast<float>(k), height);
  }
  const Surface across = surface_at(edge, kMiddle, 0.42f);
  CHECK(across.weight < 0.1f);
}

TEST_CASE("a plane seen edge-on has hardly any weight") {
  PointCloud fan;  // clutter of some depth, crossed by one beam at the height of the sensor
  for (int i = 0; i < 100; ++i)
    fan.push_back(20 + 0.1f * static_cast<float>((7 * i) % 10), 0.1f * static_cast<float>(i / 10), 0.0f);
  KdForest tree;
  tree.rebuild(fan);
  const auto weight_from = [&](float height) {
    fan.viewpoints.assign(fan.size(), {0, 0, height});
    LocalSurfaces surfaces;
    surfaces.reset(fan, tree, 1);
    surfaces.prepare({55}, 1);
    return surfaces.at(55).weight;
  };
  const float seen_from_above = weight_from(4);
  CHECK(seen_from_above > 0.3f);
  CHECK(weight_from(0.5f) < 0.2f * seen_from_above);
  CHECK(weight_from(0) == 0.0f);
}

TEST_CASE("the normal of a plane points to its viewpoint") {
  PointCloud wall;
  for (int i = 0; i < 100; ++i)
    wall.push_back(5, 0.1f * static_cast<float>(i % 10), 0.1f * static_cast<float>(i / 10));
  KdForest tree;
  tree.rebuild(wall);
  for (const float side : {-1.0f, 1.0f}) {
    wall.viewpoints.assign(wall.size(), {5 + 3 * side, 0.5f, 0.5f});
    LocalSurfaces surfaces;
    surfaces.reset(wall, tree, 1);
    surfaces.prepare({55}, 1);
    CHECK(surfaces.at(55).normal.x() == doctest::Approx(side).epsilon(1e-4));
  }
}

TEST_CASE("a wall in a planar scan is a vertical plane, and a heap of points has hardly any weight") {
  PointCloud cloud;
  std::vector<Neighbour> wall, heap;
  for (int k = -6; k <= 6; ++k) {  // 30 degrees from x, alternately 1 cm off it
    const float along = 0.1f * static_cast<float>(k), off = k % 2 ? 0.01f : -0.01f;
    cloud.push_back(3 + 0.8660254f * along - 0.5f * off, 0.5f * along + 0.8660254f * off, 0);
    wall.push_back({static_cast<std::int32_t>(cloud.size()) - 1, 0});
  }
  for (int k = 0; k < 12; ++k) {
    cloud.push_back(std::cos(static_cast<float>(k)), std::sin(static_cast<float>(k)), 0);
    heap.push_back({static_cast<std::int32_t>(cloud.size()) - 1, 0});
  }
  const Surface surface = fit_wall(cloud, wall.data(), static_cast<int>(wall.size()));
  CHECK_FALSE(surface.line);
  CHECK(std::abs(surface.normal.dot(Eigen::Vector3f(-0.5f, 0.8660254f, 0))) > 0.9995f);
  CHECK(surface.normal.z() == 0.0f);
  CHECK((surface.centre - Eigen::Vector3f(3, 0, 0)).norm() < 0.005f);
  CHECK(surface.weight > 0.9f);
  CHECK(fit_wall(cloud, heap.data(), static_cast<int>(heap.size())).weight < 0.05f);
  CHECK(fit_wall(cloud, wall.data(), 4).weight == 0.0f);
  const std::vector<Neighbour> one(6, wall[0]);
  CHECK(fit_wall(cloud, one.data(), 6).weight == 0.0f);
}

TEST_CASE("the tilt of a plane equals the scatter of its normals") {
  // Errors of 3 cm on a floor seen in narrow rows: its normals are known less well across the rows.
  std::mt19937 rng(5);
  std::normal_distribution<double> noise(0, 0.03);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::Vector2d scattered = Eigen::Vector2d::Zero(), told = Eigen::Vector2d::Zero();
  for (int trial = 0; trial < 2000; ++trial) {
    PointCloud floor;
    std::vector<Neighbour> neighbours;
    for (int i = 0; i < 12; ++i) {
      floor.push_back(static_cast<float>(0.25 * (i % 3)), static_cast<float>(uniform(rng)),
                      static_cast<float>(noise(rng)));
      neighbours.push_back({i, 0.0f});
    }
    const Surface surface = fit_surface(floor, neighbours.data(), static_cast<int>(neighbours.size()));
    const Eigen::Vector3f across = surface.tilt_across * surface.normal.cross(surface.tilt).normalized();
    scattered += surface.normal.head<2>().cast<double>().cwiseAbs2();
    told += (surface.tilt.head<2>().cwiseAbs2() + across.head<2>().cwiseAbs2()).cast<double>();
  }
  CHECK(scattered.x() > 4 * scattered.y());
  CHECK(told.x() == doctest::Approx(scattered.x()).epsilon(0.15));
  CHECK(told.y() == doctest::Approx(scattered.y()).epsilon(0.15));
}
