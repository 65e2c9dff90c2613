// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "simulation/world.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace scanlock {

WorldKind parse_world(const std::string& name) {
  constexpr std::pair<const char*, WorldKind> kNames[] = {{"urban", WorldKind::kUrban},
                                                          {"indoor", WorldKind::kIndoor},
                                                          {"forest", WorldKind::kForest},
                                                          {"tunnel", WorldKind::kTunnel},
                                                          {"field", WorldKind::kField}};
  for (const auto& [known, kind] : kNames)
    if (name == known) return kind;
  throw std::invalid_argument("unknown world '" + name + "': choose urban, indoor, forest, tunnel or field");
}

Mover make_car(const Polyline& path, double start, double speed, double reflectivity) {
  Mover car;
  car.path = path;
  car.start = start;
  car.speed = speed;
  car.boxes = {Box::upright({0, 0, 0.25}, 0, {4.4, 1.8, 0.65}, reflectivity),
               Box::upright({-0.3, 0, 0.9}, 0, {2.4, 1.55, 0.55}, 0.15)};
  return car;
}

Mover make_person(const Polyline& path, double start, double speed) {
  Mover person;
  person.path = path;
  person.start = start;
  person.speed = speed;
  Cylinder legs, trunk;
  legs.length = 0.85;
  legs.radius = 0.14;
  trunk.base = {0, 0, 0.85};
  trunk.length = 0.85;
  trunk.radius = 0.22;
  person.cylinders = {legs, trunk};
  return person;
}

double needed_length(const DriveStyle& style, double seconds) {
  const double longest = seconds + 3, faster = std::max(style.start_mps - style.fast_mps, 0.0);
  const double braked = std::min(longest, faster / style.brake);  // seconds
  return style.fast_mps * longest + faster * braked - style.brake * braked * braked / 2 + 40;
}

DriveStyle style_of(WorldKind kind) {
  DriveStyle style;
  switch (kind) {
    case WorldKind::kUrban:
      style.stop_every_m = 350;
      break;
    case WorldKind::kIndoor:  // a robot that turns almost on the spot, at up to 120 degrees per second
      style.slow_mps = 0.5;
      style.fast_mps = 1.2;
      style.accelerate = style.brake = 1;
      style.lateral = 2.5;
      style.yaw_rate = 1.6;
      style.stop_every_m = 40;
      style.sensor_height = 0.9;
      style.wheelbase = 0.4;
      style.sway = 0.004;
      style.heave = 0.003;
      style.fastest_hz = 4;
      break;
    case WorldKind::kForest:  // a quadruped
      style.slow_mps = 0.9;
      style.fast_mps = 1.6;
      style.accelerate = style.brake = 1;
      style.yaw_rate = 1;
      style.stop_every_m = 150;
      style.sensor_height = 1.0;
      style.wheelbase = 0.6;
      style.sway = 0.012;
      style.heave = 0.012;
      style.slowest_hz = 1;
      break;
    case WorldKind::kTunnel:
      style.slow_mps = 12;
      style.fast_mps = 18;
      break;
    case WorldKind::kField:  // a tractor
      style.slow_mps = 2;
      style.fast_mps = 4;
      style.accelerate = style.brake = 1;
      style.stop_every_m = 200;
      style.sensor_height = 2;
      style.sway = 0.006;
      style.heave = 0.01;
      style.fastest_hz = 2;
      break;
  }
  return style;
}

World make_world(WorldKind kind, std::uint64_t seed, const Visit& visit) {
  DriveStyle style = style_of(kind);
  if (visit.speed_mps > 0) style.slow_mps = style.fast_mps = visit.speed_mps;
  style.start_mps = visit.start_mps;
  if (visit.moved > 0 && kind != WorldKind::kUrban && kind != WorldKind::kIndoor)
    throw std::invalid_argument("this world has no objects that can be moved: choose urban or indoor");
  switch (kind) {
    case WorldKind::kUrban:
      return make_urban(seed, visit, style);
    case WorldKind::kIndoor:
      return visit.laps > 0 ? make_office_ring(seed, visit, style) : make_indoor(seed, visit, style);
    case WorldKind::kForest:
      return make_forest(seed, visit, style);
    case WorldKind::kTunnel:
      if (visit.laps > 0)
        throw std::invalid_argument(
            "the tunnel has no laps, as it is not a closed loop: choose urban, indoor, forest or field");
      return make_tunnel(seed, visit, style);
    case WorldKind::kField:
      return make_field(seed, visit, style);
  }
  throw std::invalid_argument("unknown kind of world");
}

}  // namespace scanlock
