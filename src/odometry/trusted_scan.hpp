// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "geometry/rigid.hpp"
#include "icp/scan_alignment.hpp"
#include "odometry/scan_preparation.hpp"

namespace scanlock {

/// A trusted pose of the body, its time, and the scan taken there.
struct TrustedScan {
  Pose map_from_body = Pose::Identity();
  std::int64_t utime = 0;           ///< microseconds
  Vector6 twist = Vector6::Zero();  ///< velocity, which distorts the points below
  PointCloud source,
      rays;  ///< of the scan, not deskewed; without rays no later scan is compared with this one
};

TrustedScan trusted_scan(std::int64_t utime, const PreparedScan& scan, const MovingPose& moving);

/// Contradiction of two scans in a row at their poses, without a map: the larger of the two shares of points
/// of one scan that the range image of the other contradicts (0 to 1). A few hundredths in streets with
/// traffic, through doors and in shakes, more while a lorry passes close by, and 0.15 and more at another
/// place that looks the same. A value that tells nothing after more than four seconds, in which too much may
/// have changed.
double contradiction(const TrustedScan& before, std::int64_t utime, const PreparedScan& scan,
                     const MovingPose& now);

}  // namespace scanlock
