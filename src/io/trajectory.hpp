// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "geometry/rigid.hpp"

namespace scanlock {

struct StampedPose {
  double time_s = 0;  ///< seconds; the number of the pose, from 0, where a format has no times (KITTI)
  Pose pose = Pose::Identity();
};
using Trajectory = std::vector<StampedPose>;

/// By how much the length of a quaternion may be off 1: files with three decimals exist.
inline constexpr double kQuaternionTolerance = 1e-2;

/// TUM: `time tx ty tz qx qy qz qw` a line; `#` starts a comment. Times keep microseconds.
/// KITTI: twelve numbers a line, the upper three rows of the matrix, row-major; no times.
/// Readers throw std::runtime_error "FILE:LINE: what is wrong"; a non-finite number, a quaternion whose
/// length is off by more than 1 % and a matrix that is off a rotation by more than 0.001 are errors. A file
/// without poses is an empty trajectory.
Trajectory read_tum(const std::string& path);
Trajectory read_kitti(const std::string& path);
/// Chooses by content: eight columns are TUM, twelve are KITTI. Here a file without poses is an error.
Trajectory read_trajectory(const std::string& path);
/// True when the first line with content has the eight columns of TUM; false when it has twelve; else throws.
bool is_tum(const std::string& path);

/// Writers print nine decimals (times: six) and throw std::runtime_error naming the path when a write fails.
void write_tum(const std::string& path, const Trajectory& trajectory);
void write_kitti(const std::string& path, const Trajectory& trajectory);

}  // namespace scanlock
