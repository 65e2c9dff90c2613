// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace scanlock {

/// Disturbances during a drive.
enum class EventKind : std::int8_t {
  kKidnap,    ///< the sensor is moved 3 to 15 m, to ground already driven, and turned by up to 180 degrees
  kBlackout,  ///< scans arrive, but empty (every other scan) or with at most 20 points
  kShake,     ///< strong rotational shaking
  kHalfView,  ///< the left half of the field of view is blocked: no returns from there
  kDropout,   ///< scans do not arrive at all
};

struct SimulationEvent {
  EventKind kind = EventKind::kKidnap;
  double time_s = 0;      ///< since the start of the drive
  double duration_s = 0;  ///< 0 for a kidnap

  double end_s() const { return time_s + duration_s; }
  bool active(double t) const { return t >= time_s - 1e-9 && t < end_s() - 1e-9; }
};

/// Parses `kidnap@T` or `blackout@T+D`, `shake@T+D`, `halfview@T+D`, `dropout@T+D`, in seconds. Throws
/// std::invalid_argument with a sentence that quotes the text.
SimulationEvent parse_event(const std::string& text);

}  // namespace scanlock
