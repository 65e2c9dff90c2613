// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "simulation/drive.hpp"
#include "simulation/polyline.hpp"
#include "simulation/scene.hpp"

namespace scanlock {

enum class WorldKind : std::int8_t { kUrban, kIndoor, kForest, kTunnel, kField };

/// `urban`, `indoor`, `forest`, `tunnel` or `field`; throws std::invalid_argument for any other name.
WorldKind parse_world(const std::string& name);

/// A car or a person on a path of its own. Its shapes stand on the ground at their own origin, x forward.
struct Mover {
  Polyline path;
  double start = 0;  ///< arc length at the start of the drive, metres
  double speed = 0;  ///< m/s; at its path's end it begins anew
  bool in_convoy =
      false;  ///< it keeps `start` metres before (behind, when negative) the sensor's own carrier
  std::vector<Box> boxes;
  std::vector<Cylinder> cylinders;
};
Mover make_car(const Polyline& path, double start, double speed, double reflectivity);
Mover make_person(const Polyline& path, double start, double speed);

/// What a world offers the simulator. Metres, z up, ground near z = 0.
struct World {
  Scene scene;     ///< built
  Polyline route;  ///< for the carrier of the sensor, long enough for the drive
  DriveStyle style;
  std::vector<Mover> movers;
  double lap_m = 0;       ///< length of the closed loop that the route repeats; 0: it repeats none
  double laps_end_m = 0;  ///< arc length of the route where its last lap is closed
};

/// A drive through a world.
struct Visit {
  double seconds = 0;  ///< for which the route has to be long enough,
  int laps = 0;        ///< or, where they are more than 0, for these, each a little to the side of the last
  double speed_mps =
      0;  ///< above 0 it replaces the world's own cruising speeds (bends are still taken slower)
  double start_mps = 0;  ///< as the drive begins
  /// Of the route and of who is about; none: the world's. In forest, field and tunnel the route stays.
  std::optional<std::uint64_t> seed = std::nullopt;
  double moved = 0;  ///< share of the furniture, parked cars and bins that stand elsewhere than without it
};

/// A world made from the seed, with a route for the visit.
/// With laps, indoors, it is another floor: a ring of corridors. Throws std::invalid_argument for laps in the
/// tunnel, which is a straight way, and for `moved` where nothing stands about: in forest, tunnel and field.
World make_world(WorldKind kind, std::uint64_t seed, const Visit& visit);

/// The greatest distance that a drive can need, with a margin.
double needed_length(const DriveStyle& style, double seconds);

/// One maker a world; `style` comes with its speeds settled.
DriveStyle style_of(WorldKind kind);
World make_urban(std::uint64_t seed, const Visit& visit, const DriveStyle& style);
World make_indoor(std::uint64_t seed, const Visit& visit, const DriveStyle& style);
World make_office_ring(std::uint64_t seed, const Visit& visit, const DriveStyle& style);
World make_forest(std::uint64_t seed, const Visit& visit, const DriveStyle& style);
World make_tunnel(std::uint64_t seed, const Visit& visit, const DriveStyle& style);
World make_field(std::uint64_t seed, const Visit& visit, const DriveStyle& style);

}  // namespace scanlock
