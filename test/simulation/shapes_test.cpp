// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/shapes.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace scanlock;

namespace {

Hit within(double range) {
  Hit hit;
  hit.range = range;
  return hit;
}

}  // namespace

TEST_CASE("box - a ray meets the near face and its normal faces the ray") {
  const Box box = Box::upright({5, 0, 0}, 0, {2, 2, 2});
  Hit hit = within(100);
  intersect(box, {{0, 0.5, 1}, {1, 0, 0}}, hit);
  REQUIRE(hit.found);
  CHECK(hit.range == doctest::Approx(4));
  CHECK(hit.normal.isApprox(Eigen::Vector3d(-1, 0, 0)));
}

TEST_CASE("box - turned by 45 degrees its edge is nearer by the right amount") {
  const Box box = Box::upright({5, 0, 0}, M_PI / 4, {2, 2, 2});
  Hit hit = within(100);
  intersect(box, {{0, 0, 1}, {1, 0, 0}}, hit);
  REQUIRE(hit.found);
  CHECK(hit.range == doctest::Approx(5 - std::sqrt(2.0)));
}

TEST_CASE("box - no hit behind the origin, from inside, beside it or beyond the range") {
  const Box box = Box::upright({5, 0, 0}, 0, {2, 2, 2});
  for (const Ray& ray : {Ray{{8, 0, 1}, {1, 0, 0}}, Ray{{5, 0, 1}, {1, 0, 0}}, Ray{{0, 1.1, 1}, {1, 0, 0}}}) {
    Hit hit = within(100);
    intersect(box, ray, hit);
    CHECK_FALSE(hit.found);
    CHECK(hit.range == 100);
  }
  Hit hit = within(3.9);
  intersect(box, {{0, 0, 1}, {1, 0, 0}}, hit);
  CHECK_FALSE(hit.found);
}

TEST_CASE("cylinder - leaning trunk is met on its mantle only") {
  Cylinder cylinder;
  cylinder.base = {3, 0, 0};
  cylinder.axis = Eigen::Vector3d(0, 0.1, 1).normalized();
  cylinder.length = 2;
  cylinder.radius = 0.5;
  Hit hit = within(100);
  intersect(cylinder, {{0, 0.1, 1}, {1, 0, 0}}, hit);
  REQUIRE(hit.found);
  CHECK(hit.range == doctest::Approx(2.5));
  CHECK(std::abs(hit.normal.dot(cylinder.axis)) < 1e-12);
  Hit over = within(100);
  intersect(cylinder, {{0, 0.3, 2.5}, {1, 0, 0}}, over);
  CHECK_FALSE(over.found);
}

TEST_CASE("ellipsoid - solid at its surface, leaves within it and thinning with their density") {
  Ellipsoid solid;
  solid.centre = {5, 0, 0};
  solid.radii = {1, 2, 3};
  Hit hit = within(100);
  intersect(solid, {{0, 0, 0}, {1, 0, 0}}, 0, hit);
  REQUIRE(hit.found);
  CHECK(hit.range == doctest::Approx(4));

  Ellipsoid leaves = solid;
  leaves.density = 0.5;
  int hits = 0;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    Hit leaf = within(100);
    intersect(leaves, {{0, 0, 0}, {1, 0, 0}}, i * 0x9e3779b97f4a7c15ull, leaf);
    if (!leaf.found) continue;
    ++hits;
    CHECK(leaf.range >= 4);
    CHECK(leaf.range <= 6);
  }
  CHECK(hits / 4000.0 == doctest::Approx(1 - std::exp(-1.0)).epsilon(0.02));  // 2 m at 0.5 hits a metre
}

TEST_CASE("bounds - they enclose the shape and touch it") {
  Cylinder cylinder;
  cylinder.base = {1, 2, 3};
  cylinder.axis = Eigen::Vector3d(1, 0, 0);
  cylinder.length = 4;
  cylinder.radius = 0.5;
  CHECK(bounds_of(cylinder).min().isApprox(Eigen::Vector3d(1, 1.5, 2.5)));
  CHECK(bounds_of(cylinder).max().isApprox(Eigen::Vector3d(5, 2.5, 3.5)));
  const Box box = Box::upright({0, 0, 0}, M_PI / 2, {4, 2, 1});
  CHECK(bounds_of(box).max().isApprox(Eigen::Vector3d(1, 2, 1)));
}
