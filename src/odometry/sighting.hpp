// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "geometry/rigid.hpp"
#include "icp/scan_alignment.hpp"
#include "odometry/scan_preparation.hpp"

namespace scanlock {

/// Where a body was for sure, when, and what it saw there.
struct Sighting {
  Pose map_from_body = Pose::Identity();
  std::int64_t utime = 0;           ///< microseconds
  Vector6 twist = Vector6::Zero();  ///< the motion that bends what follows
  PointCloud source, rays;          ///< of the scan, as they came; empty where it is no witness
};

Sighting sighting(std::int64_t utime, const PreparedScan& scan, const MovingPose& moving);

/// How much of two scans in a row cannot have been seen from where they are said to be (0 to 1), whatever a
/// map knows of either: the larger of the shares of the one that the other one says is not there. Some
/// hundredths in streets with traffic, through doors and in shakes, more while a lorry passes close by, and
/// 0.15 and more at another place that looks the same. 0 after more than four seconds, in which too much may
/// have changed, and of planar sensors, whose few points say too little.
double contradiction(const Sighting& before, std::int64_t utime, const PreparedScan& scan,
                     const MovingPose& now);
/// More is not seen from two places so near each other, unless something large moves.
inline constexpr double kMostContradiction = 0.1;
/// The same where nothing was seen for more than a moment: then nothing that passes by has to be let pass.
inline constexpr double kMostContradictionAfterGap = 0.05;

}  // namespace scanlock
