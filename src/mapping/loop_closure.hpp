// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mapping/pose_graph.hpp"
#include "odometry/keyframe_archive.hpp"
#include "odometry/odometer.hpp"

namespace scanlock {

/// A keyframe to be aligned with what an earlier visit saw there. A value, as RecoveryRequest.
struct ClosureRequest {
  std::int64_t serial = 0;
  ArchivedKeyframe keyframe;
  std::uint32_t nearest = 0;              ///< keyframe of the earlier visit
  std::vector<ArchivedKeyframe> earlier;  ///< around it: that visit's
  std::vector<ArchivedKeyframe> recent;   ///< around it: this visit's, without the keyframe itself
  Matrix6 covariance =
      Matrix6::Identity();  ///< of the keyframe in the frame of `nearest`, as the graph knows it
  double voxel = 0;         ///< metres
  bool planar = false;
  Odometer::Usual usual;
};

struct ClosureAnswer {
  std::int64_t serial = 0;
  bool found = false;
  Constraint constraint;  ///< from `nearest` to the keyframe
  std::string reason;     ///< in words
};

/// Aligns the keyframe with the earlier visit, from where the graph puts it. Found when as much of it is
/// explained there as in what was seen around it just now, within a fifth, no farther off than the
/// covariances allow in all but one of a thousand.
ClosureAnswer close_loop(const ClosureRequest& request, const TrackerConfig& config);

/// Bounds that the squared Mahalanobis distance of a pose exceeds once in a thousand (chi-square, 6 degrees
/// of freedom).
inline constexpr double kOnceInThousand = 22.46;

}  // namespace scanlock
