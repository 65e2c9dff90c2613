// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/place_signature.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "geometry/moved_cloud.hpp"
#include "room.hpp"

namespace scanlock {
namespace {

const Eigen::Matrix3f kLevel = Eigen::Matrix3f::Identity();

/// The walls of a rectangle around the sensor, and a floor.
PointCloud walls(float length, float width) {
  PointCloud cloud;
  for (float t = -1; t < 1; t += 0.01F) {
    for (float z = -1; z < 1.5F; z += 0.1F) {
      for (const float side : {-1.0F, 1.0F}) {
        cloud.push_back(t * length, side * width, z);
        cloud.push_back(side * length, t * width, z);
      }
    }
    for (float s = -1; s < 1; s += 0.02F) cloud.push_back(t * length, s * width, -1);
  }
  return cloud;
}

PointCloud turned(const PointCloud& cloud, double radians, double x) {
  Vector6 xi;
  xi << x, 0, 0, 0, 0, radians;
  return moved(cloud, se3_exp(xi));
}

}  // namespace

TEST_CASE("signatures of nearby viewpoints are similar at any heading, and those of another site less so") {
  const PlaceSignature here(walls(12, 5), kLevel), other(walls(7, 7), kLevel);
  CHECK(here.similarity(here) == doctest::Approx(1.0));
  for (const double heading : {0.5, 1.7, -2.9}) {
    const PlaceSignature same(turned(walls(12, 5), heading, 0), kLevel);
    const PlaceSignature near(turned(walls(12, 5), heading, 0.7), kLevel);
    CHECK(here.similarity(same) > 0.9);
    CHECK(here.similarity(near) > here.similarity(other) + 0.1);
  }
}

TEST_CASE(
    "points below the sensor do not count beside higher points, and an empty cloud is similar to none") {
  PointCloud low;
  for (float x = 2; x < 10; x += 0.1F) low.push_back(x, 1, -0.2F);
  PointCloud both = walls(12, 5);
  const PlaceSignature high(both, kLevel);
  for (std::size_t i = 0; i < low.size(); ++i) both.push_back(low.point(i));
  CHECK(high.similarity(PlaceSignature(both, kLevel)) == doctest::Approx(1.0));
  const PlaceSignature planar(low, kLevel), none(PointCloud(), kLevel);
  CHECK(planar.similarity(planar) == doctest::Approx(1.0));
  CHECK(planar.similarity(none) == 0);
  CHECK(none.similarity(none) == 0);
}

}  // namespace scanlock
