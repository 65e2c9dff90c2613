// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
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

/// A world made from the seed alone, with a route for a drive of `seconds`.
/// `speed_mps` above 0 replaces the world's own cruising speeds by this one (bends are still taken slower);
/// `start_mps` is the speed as the drive begins.
World make_world(WorldKind kind, std::uint64_t seed, double seconds, double speed_mps = 0,
                 double start_mps = 0);

/// A world whose route is a closed loop, driven `laps` times, each time a little to the side of the last.
/// Indoors it is another floor: a ring of corridors. Throws std::invalid_argument for the tunnel, which is a
/// straight way.
World make_looped_world(WorldKind kind, std::uint64_t seed, int laps, double speed_mps = 0,
                        double start_mps = 0);

/// What a route has to be long enough for: a drive of `seconds`, or, where they are more than 0, `laps`.
struct RouteExtent {
  double seconds = 0;
  int laps = 0;
};

/// The greatest distance that a drive can need, with a margin.
double needed_length(const DriveStyle& style, double seconds);

/// One maker a world; `style` comes with its speeds settled.
DriveStyle style_of(WorldKind kind);
World make_urban(std::uint64_t seed, const RouteExtent& extent, const DriveStyle& style);
World make_indoor(std::uint64_t seed, double seconds, const DriveStyle& style);
World make_office_ring(std::uint64_t seed, int laps, const DriveStyle& style);
World make_forest(std::uint64_t seed, const RouteExtent& extent, const DriveStyle& style);
World make_tunnel(std::uint64_t seed, double seconds, const DriveStyle& style);
World make_field(std::uint64_t seed, const RouteExtent& extent, const DriveStyle& style);

}  // namespace scanlock
