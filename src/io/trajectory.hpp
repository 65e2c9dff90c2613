// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "geometry/rigid.hpp"

namespace scanlock {

struct StampedPose {
  double time_s = 0;  ///< seconds; the line number where a format has no times (KITTI)
  Pose pose = Pose::Identity();
};
using Trajectory = std::vector<StampedPose>;

/// TUM: `time tx ty tz qx qy qz qw` a line; `#` starts a comment. Times keep microseconds.
/// KITTI: twelve numbers a line, the upper three rows of the matrix, row-major; no times.
/// Readers throw std::runtime_error naming file and line; a non-finite number or a matrix that is no rotation is an error.
Trajectory read_tum(const std::string& path);
Trajectory read_kitti(const std::string& path);
/// Chooses by content: eight columns are TUM, twelve are KITTI.
Trajectory read_trajectory(const std::string& path);
void write_tum(const std::string& path, const Trajectory& trajectory);
void write_kitti(const std::string& path, const Trajectory& trajectory);

}  // namespace scanlock
