// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// One turn of points at different ranges and heights, none at the origin, with times over 0.1 s.
inline Scan sample_scan(int count) {
  Scan scan;
  scan.utime = 1700000000123456;
  for (int i = 0; i < count; ++i) {
    const float share = static_cast<float>(i) / static_cast<float>(count);
    const float angle = 6.2831853f * share - 3.1415927f, range = 5.0f + 3.0f * std::sin(7.0f * angle);
    scan.points.push_back(range * std::cos(angle), range * std::sin(angle),
                          0.25f * static_cast<float>(i % 5));
    scan.points.intensity.push_back(static_cast<float>(i % 256));
    scan.points.time.push_back(0.1f * share);
  }
  return scan;
}

}  // namespace scanlock
