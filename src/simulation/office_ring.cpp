// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// The indoor world for laps: one corridor around a closed core, with offices on both sides.
#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/rigid.hpp"
#include "simulation/laps.hpp"
#include "simulation/random.hpp"
#include "simulation/rooms.hpp"
#include "simulation/world.hpp"

namespace scanlock {
namespace {

constexpr double kRouteBend = 1.4;  // metres of route over which corners are rounded

struct Ring {
  double ceiling, corridor;  // height and width, metres
  double length, width;      // of the rectangle formed by the corridor's centre line
  double inner, outer;       // depths of the offices inside and outside the ring
};

Ring plan_ring(Random& random) {
  Ring ring;
  ring.ceiling = random.uniform(2.5, 3.2);
  ring.corridor = random.uniform(2.2, 2.9);
  ring.length = random.uniform(66, 78);
  ring.width = random.uniform(124, 128) - ring.length;
  ring.inner = random.uniform(4.5, 6);
  ring.outer = random.uniform(4.5, 6);
  return ring;
}

/// Towards the corridor, an office has a wall with an open door, a wall with a closed door, or no wall.
enum class Front { kOpen, kShut, kNone };

Front draw_front(Random& random) {
  const double draw = random.uniform();
  return draw < 0.6 ? Front::kOpen : draw < 0.85 ? Front::kShut : Front::kNone;
}

/// Adds a room from x0 to x1 behind the corridor's side at y = front, `depth` metres deep; `out` is +1 when
/// the room lies towards greater y, else -1. Adds its front, its left wall and its furniture.
void add_room(Scene& scene, const Ring& ring, double x0, double x1, double front, double depth, double out,
              Random& random, Changes& changes) {
  // Range of y at a distance from `near` to `far` metres from the corridor: y is front + out * distance.
  const auto low = [&](double near, double far) { return std::min(front + out * near, front + out * far); };
  const auto block = [&](double from, double to, double near, double far, double bottom, double top) {
    add_block(scene, from, to, low(near, far), low(near, far) + far - near, bottom, top, 0.6);
  };
  const double quarter = (x1 - x0) / 4;
  const double door = x0 + 2 * quarter + random.uniform(-0.8, 0.8) * quarter;
  const Front kind = draw_front(random);
  block(x0, x0 + kWall, kWall, depth, 0, ring.ceiling);
  if (kind != Front::kNone) add_wall_with_doors(scene, ring.ceiling, x0, x1, low(0, kWall), {door});
  if (kind == Front::kShut) block(door - kDoor / 2, door + kDoor / 2, 0.05, 0.1, 0, kDoorHeight);
  if (kind == Front::kOpen) {  // the door leaf stands open into the room
    const double y = front + out * (kWall + 0.5);
    scene.add(
        Box::upright({door - kDoor / 2 - 0.03, y, 0}, random.uniform(-0.05, 0.05), {0.04, 0.95, 2.05}, 0.4));
  }
  furnish_room(scene, x0 + kWall, x1, low(kWall, depth), low(kWall, depth) + depth - kWall, door, random,
               changes);
  if (kind != Front::kNone && random.chance(0.5)) {  // a cupboard in the corridor, beside the door
    const double from = door < (x0 + x1) / 2 ? x1 - random.uniform(0.7, 1.2) : x0 + 0.1;
    const double height = random.uniform(0.9, 2), cupboard = random.uniform(0.15, 0.35);
    block(from, from + 0.6, -cupboard, 0, 0, height);
  }
}

/// Adds a row of rooms of random widths, with the walls at its end and back.
void add_row(Scene& scene, const Ring& ring, double x0, double x1, double front, double depth, double out,
             Random& random, Changes& changes) {
  const double back = front + out * (depth + kWall / 2);
  add_block(scene, x0, x1, back - kWall / 2, back + kWall / 2, 0, ring.ceiling, 0.6);
  const double end = front + out * depth / 2;
  add_block(scene, x1 - kWall, x1, end - depth / 2, end + depth / 2, 0, ring.ceiling, 0.6);
  double x = x0;
  while (x1 - x > 11) {
    const double width = random.uniform(4, 6.5);
    add_room(scene, ring, x, x + width, front, depth, out, random, changes);
    x += width;
  }
  if (x1 - x > 6.5) {  // 6.5 to 11 m are left: two rooms of the same width
    const double width = (x1 - x) / 2;
    add_room(scene, ring, x, x + width, front, depth, out, random, changes);
    x += width;
  }
  add_room(scene, ring, x, x1, front, depth, out, random, changes);
}

/// Adds one of the ring's four sides in a frame of its own: the corridor's centre line runs along x from
/// corner to corner, 0 to `length`, and the inside of the ring is at greater y. The room in an inner corner
/// belongs to the side that ends there.
void add_side(Scene& scene, const Ring& ring, double length, const Eigen::Vector2d& corner, double yaw,
              Random& random, Changes& changes) {
  const double half = ring.corridor / 2;
  Scene side;
  add_row(side, ring, -half, length + half, -half, ring.outer, -1, random, changes);
  add_row(side, ring, half + ring.inner, length - half, half, ring.inner, 1, random, changes);

  const Eigen::Matrix3d turn = rotation_about_z(yaw);
  const Eigen::Vector3d origin(corner.x(), corner.y(), 0);
  for (Box box : side.boxes()) {
    box.centre = origin + turn * box.centre;
    box.world_from_box = turn * box.world_from_box;
    scene.add(box);
  }
  for (Cylinder cylinder : side.cylinders()) {
    cylinder.base = origin + turn * cylinder.base;
    scene.add(cylinder);
  }
}

/// People who walk round in both directions, each at a different speed, so that the laps meet them at
/// different positions.
void add_people(World& world, const Polyline& lap, Random& random) {
  for (int i = 0; i < 6; ++i) {
    const Polyline path = (i % 2 == 0 ? lap : lap.reversed()).offset(random.uniform(-0.6, -0.4));
    const double speed = random.uniform(0.7, 1.4), start = random.uniform(0, path.length());
    world.movers.push_back(make_person(path, start, speed));
  }
}

}  // namespace

World make_office_ring(std::uint64_t seed, const Visit& visit, const DriveStyle& style) {
  Random random(seed, 21);
  Changes changes(seed, visit);
  const Ring ring = plan_ring(random);
  const double margin = ring.corridor / 2 + ring.outer + 2;
  const std::vector<Eigen::Vector2d> corners = {
      {0, 0}, {ring.length, 0}, {ring.length, ring.width}, {0, ring.width}};
  World world;
  world.style = style;
  world.scene = Scene(Terrain({-margin, -margin}, {ring.length + margin, ring.width + margin}, 1,
                              [](double, double) { return 0.0; }));
  world.scene.set_ceiling(ring.ceiling);
  for (int side = 0; side < 4; ++side)
    add_side(world.scene, ring, side % 2 == 0 ? ring.length : ring.width, corners[side], side * kPi / 2,
             random, changes);
  world.scene.build();
  if (visit.seed) random = Random(*visit.seed, 21);

  std::vector<Eigen::Vector2d> way = {{ring.length / 2, 0}, corners[1], corners[2], corners[3], corners[0]};
  if (random.chance(0.5)) std::reverse(way.begin() + 1, way.end());
  const Polyline lap = closed_lap(way, 0.05, kRouteBend);
  constexpr Wander kWander{0.2, 7};
  set_laps(world, lap, visit.laps, kWander, random);
  add_people(world, lap, random);
  return world;
}

}  // namespace scanlock
