// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/standing_alone.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "geometry/angles.hpp"

namespace scanlock {
namespace {

/// The range along an azimuth (radians) at a slope; 0 where the ray hits nothing.
using Scene = std::function<double(double azimuth, double slope)>;

double wall_range(double x, double azimuth) {
  return std::cos(azimuth) > 1e-3 ? x / std::cos(azimuth) : 0;
}

/// Whether a bar `width` metres wide at `range` and `azimuth` is hit.
bool hits(double azimuth, double at, double range, double width) {
  return std::abs(azimuth - at) * range < 0.5 * width;
}

PointCloud spun(const Scene& scene, double step = 0.2 * kDegree) {
  PointCloud cloud;
  for (int beam = -8; beam < 8; ++beam) {
    const double slope = std::tan((2 * beam + 1) * kDegree);
    for (double azimuth = -0.5; azimuth < 0.5; azimuth += step) {
      const double range = scene(azimuth, slope);
      if (range > 0)
        cloud.push_back(Eigen::Vector3d(range * std::cos(azimuth), range * std::sin(azimuth), range * slope)
                            .cast<float>());
    }
  }
  return cloud;
}

std::vector<std::uint8_t> alone_of(const PointCloud& cloud, float reach = 1) {
  std::vector<std::uint32_t> all(cloud.size());
  std::iota(all.begin(), all.end(), 0u);
  return standing_alone(cloud, all, cloud, reach);
}

}  // namespace

TEST_CASE("a post before a wall or the sky stands alone, and a wide board does not") {
  for (const bool wall : {true, false}) {
    CAPTURE(wall);
    const auto bar = [&](double width) -> Scene {
      return [=](double azimuth, double) {
        if (hits(azimuth, 0.1, 20, width)) return 20.0;
        return wall ? wall_range(40, azimuth) : 0.0;
      };
    };
    // The ground shows the angular resolution of the sensor.
    const auto with_ground = [](const Scene& scene) -> Scene {
      return [=](double azimuth, double slope) {
        const double ground = slope < 0 ? -1.8 / slope : 1e9, range = scene(azimuth, slope);
        return range > 0 && range < ground ? range : ground < 100 ? ground : 0;
      };
    };
    const PointCloud cloud = spun(with_ground(bar(0.3)));
    const std::vector<std::uint8_t> alone = alone_of(cloud);
    int posts = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const bool on_post = std::abs(std::hypot(cloud.x[i], cloud.y[i]) - 20) < 0.01 && cloud.z[i] > -1.5;
      CHECK(static_cast<bool>(alone[i]) == on_post);
      posts += on_post;
    }
    CHECK(posts > 10);
    const std::vector<std::uint8_t> wide = alone_of(spun(with_ground(bar(4))));
    CHECK(std::count(wide.begin(), wide.end(), 1) == 0);
  }
}

TEST_CASE("distant points of a surface seen at a grazing angle do not stand alone") {
  // A wall 4 m to the left: from 30 m on its points are more than a metre apart.
  const auto side = [](double azimuth, double) {
    const double range = azimuth > 1e-3 ? 4 / std::sin(azimuth) : 0;
    return range < 100 ? range : 0;
  };
  const PointCloud cloud = spun(side);
  const std::vector<std::uint8_t> alone = alone_of(cloud);
  CHECK(std::count(alone.begin(), alone.end(), 1) <= 16);  // the last point of each beam
}

TEST_CASE("a wall seen by a sensor with a random pattern has no point that stands alone") {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  PointCloud cloud;
  for (int i = 0; i < 2000; ++i) {
    const double azimuth = uniform(rng), range = wall_range(15, azimuth);
    cloud.push_back(Eigen::Vector3d(15, range * std::sin(azimuth), range * 0.8 * uniform(rng)).cast<float>());
  }
  const std::vector<std::uint8_t> alone = alone_of(cloud);
  CHECK(std::count(alone.begin(), alone.end(), 1) == 0);
}

TEST_CASE("clouds without points, and points straight above and below the sensor, are handled") {
  CHECK(alone_of({}).empty());
  PointCloud cloud;
  cloud.push_back(0, 0, 5);
  cloud.push_back(0, 0, -5);
  cloud.push_back(1, 0, 0);
  CHECK(alone_of(cloud) == std::vector<std::uint8_t>{0, 0, 0});
}

}  // namespace scanlock
