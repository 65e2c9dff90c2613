// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "geometry/linear.hpp"
#include "geometry/rigid.hpp"

namespace scanlock {

/// A measured relative pose of two keyframes.
struct Constraint {
  std::uint32_t from = 0, to = 0;   ///< ids of the keyframes
  Pose from_to = Pose::Identity();  ///< transforms coordinates in `to` to coordinates in `from`
  /// Inverse covariance of log(from_to^-1 from^-1 to): [metres; radians] in the frame of `to`.
  Matrix6 information = Matrix6::Identity();
  bool loop_closure = false;  ///< true: by alignment of the two keyframes, may be wrong; false: by odometry
};

}  // namespace scanlock
