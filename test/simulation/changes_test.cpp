// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/changes.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "simulation/world.hpp"

using namespace scanlock;

namespace {

/// The share of the boxes of one world that are also in the other.
double shared_boxes(const World& a, const World& b) {
  const auto less = [](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  };
  std::vector<Eigen::Vector3d> others;
  for (const Box& box : b.scene.boxes()) others.push_back(box.centre);
  std::sort(others.begin(), others.end(), less);
  const auto& boxes = a.scene.boxes();
  const auto shared = std::count_if(boxes.begin(), boxes.end(), [&](const Box& box) {
    return std::binary_search(others.begin(), others.end(), box.centre, less);
  });
  return static_cast<double>(shared) / static_cast<double>(boxes.size());
}

bool same_route(const World& a, const World& b) {
  return a.route.points() == b.route.points();
}

Visit visit_of(double moved) {
  Visit visit;
  visit.seconds = 60;
  visit.seed = 9;
  visit.moved = moved;
  return visit;
}

}  // namespace

TEST_CASE("changes - another drive goes another way in the same world") {
  for (const WorldKind kind : {WorldKind::kUrban, WorldKind::kIndoor}) {
    const World world = make_world(kind, 4, {60}), again = make_world(kind, 4, visit_of(0));
    CHECK(shared_boxes(world, again) == 1);
    CHECK(world.scene.cylinders().size() == again.scene.cylinders().size());
    CHECK_FALSE(same_route(world, again));
    CHECK(same_route(again, make_world(kind, 4, visit_of(0))));
  }
}

TEST_CASE("changes - the requested share of objects is moved, and the others stay where they were") {
  for (const WorldKind kind : {WorldKind::kUrban, WorldKind::kIndoor}) {
    const World world = make_world(kind, 4, {60});
    double last = 1;
    for (const double moved : {0.1, 0.3, 1.0}) {
      const World changed = make_world(kind, 4, visit_of(moved));
      const double shared = shared_boxes(world, changed);
      CHECK(shared < last);
      last = shared;
      CHECK(same_route(changed, make_world(kind, 4, visit_of(0))));
    }
    CHECK(last > 0.3);  // walls, doors, houses and pavements
    // Of the boxes that all move at 1.0, about 0.3 move at 0.3.
    const double third = shared_boxes(world, make_world(kind, 4, visit_of(0.3)));
    CHECK(1 - third == doctest::Approx(0.3 * (1 - last)).epsilon(0.2));
  }
}

TEST_CASE("changes - worlds without movable objects refuse changes") {
  for (const WorldKind kind : {WorldKind::kForest, WorldKind::kTunnel, WorldKind::kField})
    CHECK_THROWS_AS(make_world(kind, 4, visit_of(0.1)), std::invalid_argument);
  CHECK_NOTHROW(make_world(WorldKind::kForest, 4, visit_of(0)));
}
