// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "geometry/rigid.hpp"

namespace scanlock {

struct StampedPose {
  double time_s = 0;  ///< seconds; in a format without times (KITTI), the index of the pose, from 0
  Pose pose = Pose::Identity();
};
using Trajectory = std::vector<StampedPose>;

/// Permitted deviation of a quaternion's length from 1: some files have only three decimals.
inline constexpr double kQuaternionTolerance = 1e-2;

/// TUM: `time tx ty tz qx qy qz qw` per line; `#` starts a comment. Times keep microseconds.
/// KITTI: twelve numbers per line, the upper three rows of the matrix, row-major; no times.
/// The readers throw std::runtime_error "FILE:LINE: what is wrong" for a non-finite number, a quaternion
/// whose length differs from 1 by more than 1 %, and a matrix R for which an element of R R^T - I exceeds
/// 0.001. A file without poses gives an empty trajectory.
Trajectory read_tum(const std::string& path);
Trajectory read_kitti(const std::string& path);
/// Chooses the format by content: eight columns are TUM, twelve are KITTI. A file without poses is an error.
Trajectory read_trajectory(const std::string& path);
/// True when the first line with content has eight columns (TUM), false when it has twelve (KITTI); throws
/// otherwise.
bool is_tum(const std::string& path);

/// The writers print nine decimals (times: six) and throw std::runtime_error naming the path when a write
/// fails.
void write_tum(const std::string& path, const Trajectory& trajectory);
void write_kitti(const std::string& path, const Trajectory& trajectory);

}  // namespace scanlock
