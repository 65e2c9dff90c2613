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

/// A car or a person on a path of its own. Its shapes are relative to its position on the ground, x forward.
struct Mover {
  Polyline path;
  double start = 0;  ///< metres, arc length at the start of the drive
  double speed = 0;  ///< m/s; at the end of its path it restarts at the beginning
  bool in_convoy =
      false;  ///< it stays `start` metres in front of (when negative, behind) the carrier of the sensor
  std::vector<Box> boxes;
  std::vector<Cylinder> cylinders;
};
Mover make_car(const Polyline& path, double start, double speed, double reflectivity);
Mover make_person(const Polyline& path, double start, double speed);

/// A world for the simulator. Metres, z up, ground near z = 0.
struct World {
  Scene scene;     ///< built
  Polyline route;  ///< of the carrier of the sensor, long enough for the drive
  DriveStyle style;
  std::vector<Mover> movers;
  double lap_m = 0;       ///< length of the closed loop that the route repeats; 0: no loop
  double laps_end_m = 0;  ///< arc length on the route at which its last lap is closed
};

/// The parameters of a drive through a world.
struct Visit {
  double seconds = 0;    ///< duration for which the route has to be long enough,
  int laps = 0;          ///< or, when above 0, the number of laps, each shifted sideways a little
  double speed_mps = 0;  ///< m/s; above 0, replaces the world's cruising speeds (bends are still slower)
  double start_mps = 0;  ///< m/s, at the start of the drive
  /// For the route and the traffic; nothing: the world's seed. In forest, field and tunnel the route does not
  /// depend on it.
  std::optional<std::uint64_t> seed = std::nullopt;
  double moved = 0;  ///< fraction of the furniture, parked cars and bins that are moved
};

/// Makes a world from the seed, with a route for the visit. Indoors, a visit with laps gets another floor
/// plan: a ring of corridors. Throws std::invalid_argument for laps in the tunnel, which has no closed route,
/// and for `moved` in forest, tunnel and field, which have no movable objects.
World make_world(WorldKind kind, std::uint64_t seed, const Visit& visit);

/// Upper bound of the distance of a drive of `seconds`, in metres, with a margin.
double needed_length(const DriveStyle& style, double seconds);

/// The default style of a world, and one function per world that makes it, with the speeds in `style` set.
DriveStyle style_of(WorldKind kind);
World make_urban(std::uint64_t seed, const Visit& visit, const DriveStyle& style);
World make_indoor(std::uint64_t seed, const Visit& visit, const DriveStyle& style);
World make_office_ring(std::uint64_t seed, const Visit& visit, const DriveStyle& style);
World make_forest(std::uint64_t seed, const Visit& visit, const DriveStyle& style);
World make_tunnel(std::uint64_t seed, const Visit& visit, const DriveStyle& style);
World make_field(std::uint64_t seed, const Visit& visit, const DriveStyle& style);

}  // namespace scanlock
