// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "odometry/keyframe_points.hpp"

namespace scanlock {

/// Stored points that cannot be read, as of a file that was overwritten.
class LostPoints : public StoredPoints {
 public:
  std::size_t size() const override { return 36; }
  PointCloud read() const override { throw PointsUnreadable("yard.map: was changed"); }
};

inline KeyframePoints lost_points() {
  return KeyframePoints(std::make_shared<const LostPoints>());
}

}  // namespace scanlock
