// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace scanlock {

/// Everything about the odometry that can be set. The defaults serve a car and a room alike: lengths that depend on the
/// scene follow its size. `daemon/config.cpp` lists every member with its unit, range and one line of explanation.
struct TrackerConfig {
  double min_range_m = 0.5;    ///< returns nearer than this are the robot itself
  double max_range_m = 120.0;  ///< returns farther than this are dropped
  int threads = 1;             ///< worker threads of one alignment; the result does not depend on it

  int max_keyframes = 40;
  int max_map_points = 200000;
  double restart_after_s = 1.0;  ///< a scan earlier than its predecessor by more than this starts anew (a log that loops)
};

}  // namespace scanlock
