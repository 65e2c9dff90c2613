// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/scene.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <utility>

#include "brute_force.hpp"
#include "simulation/random.hpp"
#include "simulation/world.hpp"

using namespace scanlock;

namespace {

Eigen::Vector3d random_direction(Random& random) {
  const double azimuth = random.uniform(-M_PI, M_PI), elevation = random.uniform(-0.4, 0.4);
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

}  // namespace

TEST_CASE("scene - the grid gives the hit that a test of every shape gives, in every world") {
  for (const WorldKind kind :
       {WorldKind::kUrban, WorldKind::kIndoor, WorldKind::kForest, WorldKind::kTunnel, WorldKind::kField}) {
    const World world = make_world(kind, 5, {20});
    Random random(7);
    int found = 0;
    for (int i = 0; i < 100; ++i) {
      const double s = random.uniform(0, world.route.length());
      const Eigen::Vector2d place = world.route.at(s);
      const Ray ray{{place.x(), place.y(), world.scene.terrain().height(place.x(), place.y()) + 1},
                    random_direction(random)};
      const auto seed = static_cast<std::uint64_t>(i);
      const Hit fast = world.scene.cast(ray, 50, seed), slow = cast_at_all(world.scene, ray, 50, seed);
      CHECK(fast.found == slow.found);
      CHECK(fast.range == doctest::Approx(slow.range).epsilon(1e-6));
      found += fast.found;
    }
    CHECK(found > 35);
  }
}

TEST_CASE("scene - rays along the axes, on borders of cells and from outside are no special case") {
  Scene scene(Terrain({0, 0}, {20, 20}, 2, [](double, double) { return 0.0; }));
  scene.add(Box::upright({15, 10, 0}, 0, {1, 4, 3}));
  scene.build();
  CHECK(scene.cast({{4, 10, 1}, {1, 0, 0}}, 50, 0).range == doctest::Approx(10.5));
  CHECK(scene.cast({{-5, 10, 1}, {1, 0, 0}}, 50, 0).range == doctest::Approx(19.5));
  CHECK(scene.cast({{15, 2, 1}, {0, 1, 0}}, 50, 0).range == doctest::Approx(6));
  CHECK(scene.cast({{10, 10, 1}, {0, 0, -1}}, 50, 0).range == doctest::Approx(1));
  CHECK_FALSE(scene.cast({{4, 10, 1}, {-1, 0, 0}}, 50, 0).found);
  CHECK_FALSE(scene.cast({{-5, -1, 1}, {1, 0, 0}}, 50, 0).found);
}

TEST_CASE("terrain - height is continuous over the border of two cells") {
  const Terrain terrain({0, 0}, {10, 10}, 1, [](double x, double y) { return std::sin(x) * std::cos(y); });
  for (double y = 0.05; y < 10; y += 0.1)
    CHECK(terrain.height(3 - 1e-9, y) == doctest::Approx(terrain.height(3 + 1e-9, y)).epsilon(1e-6));
  CHECK(terrain.height(4, 7) == doctest::Approx(std::sin(4) * std::cos(7)));
}
