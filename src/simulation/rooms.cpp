// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/rooms.hpp"

#include <cmath>

#include "geometry/rigid.hpp"

namespace scanlock {
namespace {

constexpr int kAttempts = 40;  // to find a position for a piece of furniture

void add_table(Scene& scene, const Eigen::Vector2d& p, double yaw, Random& random) {
  const double length = random.uniform(0.9, 1.7), width = random.uniform(0.6, 0.9),
               height = random.uniform(0.68, 0.78);
  scene.add(Box::upright({p.x(), p.y(), height - 0.03}, yaw, {length, width, 0.03}, 0.5));
  const Eigen::Matrix2d turn = rotation_about_z(yaw).topLeftCorner<2, 2>();
  for (const double sx : {-1.0, 1.0})
    for (const double sy : {-1.0, 1.0}) {
      const Eigen::Vector2d leg =
          p + turn * Eigen::Vector2d(sx * (length / 2 - 0.05), sy * (width / 2 - 0.05));
      scene.add(Cylinder{{leg.x(), leg.y(), 0}, Eigen::Vector3d::UnitZ(), height - 0.03, 0.03, 0.5});
    }
  if (random.chance(0.6))  // a screen on it
    scene.add(Box::upright({p.x(), p.y(), height}, yaw, {0.55, 0.06, 0.4}, 0.1));
}

}  // namespace

void add_block(Scene& scene, double x0, double x1, double y0, double y1, double z0, double z1,
               double reflectivity) {
  scene.add(Box::upright({(x0 + x1) / 2, (y0 + y1) / 2, z0}, 0, {x1 - x0, y1 - y0, z1 - z0}, reflectivity));
}

void add_wall_with_doors(Scene& scene, double ceiling, double x0, double x1, double y,
                         const std::vector<double>& doors) {
  double from = x0;
  for (const double door : doors) {
    add_block(scene, from, door - kDoor / 2, y, y + kWall, 0, ceiling, 0.6);
    add_block(scene, door - kDoor / 2, door + kDoor / 2, y, y + kWall, kDoorHeight, ceiling, 0.6);
    from = door + kDoor / 2;
  }
  add_block(scene, from, x1, y, y + kWall, 0, ceiling, 0.6);
}

void furnish_room(Scene& scene, double x0, double x1, double y0, double y1, double door, Random& random,
                  Changes& changes) {
  const int pieces = random.integer(5, 11);
  const auto draw = [&](bool against_wall, Random& dice) {
    const bool left = dice.chance(0.5);
    const double y = dice.uniform(y0 + 0.6, y1 - 0.6), x = dice.uniform(x0 + 0.6, x1 - 0.6);
    if (against_wall) return Eigen::Vector2d(left ? x0 + 0.25 : x1 - 0.25, y);
    return Eigen::Vector2d(x, y);
  };
  for (int attempt = 0, placed = 0; attempt < kAttempts && placed < pieces; ++attempt) {
    const bool against_wall = random.chance(0.5);
    const auto is_free = [&](const Eigen::Vector2d& p) {
      return std::abs(p.x() - door) >= (against_wall ? 1.1 : 1.75);
    };
    Eigen::Vector2d p = draw(against_wall, random);
    if (!is_free(p)) continue;
    ++placed;
    if (changes.next()) {
      Eigen::Vector2d to = draw(against_wall, changes.random());
      for (int i = 1; i < kAttempts && !is_free(to); ++i) to = draw(against_wall, changes.random());
      if (is_free(to)) p = to;
    }
    const Eigen::Vector3d place(p.x(), p.y(), 0);
    if (against_wall) {  // a cupboard or a shelf
      scene.add(Box::upright(place, 0, {0.45, random.uniform(0.6, 1.6), random.uniform(0.8, 2.1)}, 0.45));
    } else if (random.chance(0.6)) {
      add_table(scene, p, random.uniform(0, 3.14), random);
    } else if (random.chance(0.5)) {  // a chair
      scene.add(
          Box::upright(place + Eigen::Vector3d(0, 0, 0.38), random.uniform(0, 3), {0.42, 0.42, 0.08}, 0.3));
      scene.add(Cylinder{place, Eigen::Vector3d::UnitZ(), 0.4, 0.05, 0.3});
      scene.add(Box::upright(place + Eigen::Vector3d(0.2, 0, 0.46), 0, {0.05, 0.42, 0.45}, 0.3));
    } else {  // a column
      scene.add(Cylinder{place, Eigen::Vector3d::UnitZ(), 4, random.uniform(0.15, 0.25), 0.5});
    }
  }
}

}  // namespace scanlock
