// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "simulation/random.hpp"
#include "simulation/rooms.hpp"
#include "simulation/world.hpp"

namespace scanlock {
namespace {

constexpr int kCorridors = 6;  // in each direction

/// One floor of an office: corridors in two directions, and in each block between four corridors two rooms,
/// each with a door to the corridor below and a door to the corridor above.
struct Floor {
  double ceiling, corridor;                             // metres, height and width
  std::vector<double> x, y;                             // centre lines of the corridors
  std::vector<std::vector<std::vector<double>>> doors;  // x of the doors of each block [column][row][room]
};

Floor plan_floor(Random& random) {
  Floor floor;
  floor.ceiling = random.uniform(2.5, 3.2);
  floor.corridor = random.uniform(2.2, 2.9);
  double x = 0, y = 0;
  for (int i = 0; i < kCorridors; ++i) {
    floor.x.push_back(x);
    floor.y.push_back(y);
    x += random.uniform(13, 18);
    y += random.uniform(8, 13);
  }
  floor.doors.resize(kCorridors - 1);
  for (int i = 0; i + 1 < kCorridors; ++i) {
    floor.doors[i].resize(kCorridors - 1);
    const double low = floor.x[i] + floor.corridor / 2, high = floor.x[i + 1] - floor.corridor / 2;
    for (auto& doors : floor.doors[i]) {
      const double quarter = (high - low) / 4;
      doors = {low + quarter + random.uniform(-0.8, 0.4) * (quarter - 1.3),
               high - quarter + random.uniform(-0.4, 0.8) * (quarter - 1.3)};
    }
  }
  return floor;
}

void add_rooms(Scene& scene, const Floor& floor, int column, int row, Random& random, Changes& changes) {
  const double half = floor.corridor / 2;
  const double x0 = floor.x[column] + half, x1 = floor.x[column + 1] - half;
  const double y0 = floor.y[row] + half, y1 = floor.y[row + 1] - half;
  const std::vector<double>& doors = floor.doors[column][row];
  add_wall_with_doors(scene, floor.ceiling, x0, x1, y0, doors);
  add_wall_with_doors(scene, floor.ceiling, x0, x1, y1 - kWall, doors);
  const double split = (doors[0] + doors[1]) / 2;
  for (const double x : {x0, split - kWall / 2, x1 - kWall})
    add_block(scene, x, x + kWall, y0 + kWall, y1 - kWall, 0, floor.ceiling, 0.6);
  for (const double door : doors)  // door leaves stand open into the room
    for (const bool top : {false, true})
      if (random.chance(0.7)) {
        const double y = top ? y1 - kWall - 0.5 : y0 + kWall + 0.5;
        scene.add(Box::upright({door - kDoor / 2 - 0.03, y, 0}, random.uniform(-0.05, 0.05),
                               {0.04, 0.95, 2.05}, 0.4));
      }
  furnish_room(scene, x0 + kWall, split - kWall / 2, y0 + kWall, y1 - kWall, doors[0], random, changes);
  furnish_room(scene, split + kWall / 2, x1 - kWall, y0 + kWall, y1 - kWall, doors[1], random, changes);
  if (random.chance(0.6)) {  // an object at the corridor's wall, between the doors
    const double height = random.uniform(0.9, 2), depth = random.uniform(0.15, 0.35);
    add_block(scene, split - 0.6, split + 0.6, y1, y1 + depth, 0, height, 0.5);
  }
  if (random.chance(0.4)) {
    const double height = random.uniform(0.9, 2), width = random.uniform(0.5, 1.5);
    add_block(scene, x1, x1 + 0.25, y0 + 1, y0 + 1 + width, 0, height, 0.5);
  }
}

void add_outer_walls(Scene& scene, const Floor& floor) {
  const double half = floor.corridor / 2, thick = 0.4;
  const double x0 = floor.x.front() - half, x1 = floor.x.back() + half;
  const double y0 = floor.y.front() - half, y1 = floor.y.back() + half;
  add_block(scene, x0 - thick, x1 + thick, y0 - thick, y0, 0, floor.ceiling, 0.6);
  add_block(scene, x0 - thick, x1 + thick, y1, y1 + thick, 0, floor.ceiling, 0.6);
  add_block(scene, x0 - thick, x0, y0, y1, 0, floor.ceiling, 0.6);
  add_block(scene, x1, x1 + thick, y0, y1, 0, floor.ceiling, 0.6);
  for (double x = x0 + 3; x < x1; x += 4.7) {
    add_block(scene, x, x + 0.4, y0, y0 + 0.2, 0, floor.ceiling, 0.5);
    add_block(scene, x, x + 0.4, y1 - 0.2, y1, 0, floor.ceiling, 0.5);
  }
  for (double y = y0 + 2; y < y1; y += 5.3) {
    add_block(scene, x0, x0 + 0.2, y, y + 0.4, 0, floor.ceiling, 0.5);
    add_block(scene, x1 - 0.2, x1, y, y + 0.4, 0, floor.ceiling, 0.5);
  }
}

/// From crossing to crossing; a leg along x often leads through a room into the next corridor.
Polyline plan_walk(const Floor& floor, double length, Random& random) {
  int column = kCorridors / 2, row = kCorridors / 2, heading = random.integer(0, 3);
  const int dx[4] = {1, 0, -1, 0}, dy[4] = {0, 1, 0, -1};
  const auto inside = [](int c, int r) { return c >= 0 && r >= 0 && c < kCorridors && r < kCorridors; };
  const auto jitter = [&] { return random.uniform(-0.2, 0.2); };
  std::vector<Eigen::Vector2d> points = {{floor.x[column], floor.y[row]}};
  double walked = 0;
  while (walked < length + 20) {
    const int next_column = column + dx[heading];
    int next_row = row + dy[heading];
    const int beyond = row + (random.chance(0.5) ? 1 : -1);
    if (dy[heading] == 0 && inside(column, beyond) && random.chance(0.6)) {
      const auto& doors = floor.doors[std::min(column, next_column)][std::min(row, beyond)];
      const double middle = doors[random.integer(0, 1)];
      const double door = middle + random.uniform(-0.08, 0.08);
      points.push_back({door, floor.y[row] + jitter()});
      points.push_back({door, floor.y[beyond] + jitter()});
      next_row = beyond;
    }
    walked += std::abs(floor.x[next_column] - floor.x[column]) + std::abs(floor.y[next_row] - floor.y[row]);
    column = next_column;
    row = next_row;
    points.push_back({floor.x[column] + jitter(), floor.y[row] + jitter()});
    const int straight = heading;
    do {
      heading = (straight + random.integer(-1, 1) + 4) % 4;
    } while (!inside(column + dx[heading], row + dy[heading]));
  }
  return Polyline(points).smoothed(0.05, 0.8);
}

}  // namespace

World make_indoor(std::uint64_t seed, const Visit& visit, const DriveStyle& style) {
  Random random(seed, 20);
  Changes changes(seed, visit);
  const Floor floor = plan_floor(random);
  World world;
  world.style = style;
  world.scene = Scene(
      Terrain({-4, -4}, {floor.x.back() + 4, floor.y.back() + 4}, 1, [](double, double) { return 0.0; }));
  world.scene.set_ceiling(floor.ceiling);
  add_outer_walls(world.scene, floor);
  for (int column = 0; column + 1 < kCorridors; ++column)
    for (int row = 0; row + 1 < kCorridors; ++row)
      add_rooms(world.scene, floor, column, row, random, changes);
  world.scene.build();
  if (visit.seed) random = Random(*visit.seed, 20);
  world.route = plan_walk(floor, needed_length(style, visit.seconds), random);
  for (const double y : floor.y) {  // a person in each corridor
    const Polyline line({{floor.x.front(), y + 0.6}, {floor.x.back(), y + 0.6}});
    const double speed = random.uniform(0.7, 1.4), start = random.uniform(0, line.length());
    world.movers.push_back(make_person(line, start, speed));
  }
  return world;
}

}  // namespace scanlock
