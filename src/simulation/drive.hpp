// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/event.hpp"
#include "simulation/polyline.hpp"
#include "simulation/pose_spline.hpp"
#include "simulation/terrain.hpp"

namespace scanlock {

/// How the carrier of the sensor moves. Metres, seconds, radians.
struct DriveStyle {
  double slow_mps = 8, fast_mps = 14;  ///< range of the cruising speed, which varies along the route, m/s
  double start_mps = 0;                ///< at the start of the drive, m/s
  double accelerate = 2, brake = 2.5;  ///< m/s^2
  double lateral = 3;                  ///< greatest lateral acceleration in bends, m/s^2
  double yaw_rate = 0.7;               ///< greatest turning rate, rad/s
  double stop_every_m = 0;             ///< mean distance between stops of 2 to 6 s; 0: no stops
  double sensor_height = 1.8;          ///< above the ground
  double wheelbase = 2.7;              ///< length and width over which the carrier tilts with the ground
  double sway = 0.003, heave = 0.006;  ///< RMS of roll and pitch (rad) and of height (m) at full speed
  double slowest_hz = 0.7, fastest_hz = 2.5;  ///< frequencies of sway and heave
};

/// A drive along a route: speeds, stops, suspension, and the events that move the sensor.
class Drive {
 public:
  /// Throws std::invalid_argument when a kidnap comes before 3 m have been driven.
  Drive(const Polyline& route, const Terrain& terrain, const DriveStyle& style,
        const std::vector<SimulationEvent>& events, double seconds, std::uint64_t seed);

  /// Kidnaps divide the motion into pieces. Returns the index of the piece at time t, in seconds.
  std::size_t piece_at(double t) const;
  std::size_t pieces() const { return pieces_.size(); }
  /// Pose of the sensor in the world; smooth within a piece, which extends slightly beyond both its ends.
  const PoseSpline& piece(std::size_t index) const { return pieces_[index].spline; }

  /// Metres along the route at time t, as driven without kidnaps.
  double distance(double t) const;

 private:
  struct Piece {
    double begin;
    PoseSpline spline;
  };
  std::vector<double> distance_;  // at the knots
  std::vector<Piece> pieces_;
};

/// Seconds until a Drive with the same route, style and seed has driven `distance_m` along the route.
double driving_time(const Polyline& route, const DriveStyle& style, double distance_m, std::uint64_t seed);

}  // namespace scanlock
