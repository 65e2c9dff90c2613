// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "geometry/rigid.hpp"
#include "odometry/motion_filter.hpp"
#include "odometry/scan_preparation.hpp"
#include "odometry/scan_view.hpp"

namespace scanlock {

/// Where a body was for sure, when, and what it saw there.
struct Sighting {
  Pose map_from_body = Pose::Identity();
  std::int64_t utime = 0;  ///< microseconds
  bool looked_around = false;
  Vector6 twist = Vector6::Zero();  ///< the motion that bends what follows
  PointCloud source;                ///< as it came, at this twist; empty where nothing is known of it
  ScanView view;                    ///< the same
  double usual_contradiction = 0;   ///< about the most that there was lately

  /// It is no witness of what is there.
  void forget_view() { source = {}; }
};

/// `before`, the one before, was contradicted by so much.
Sighting sighting(std::int64_t utime, const PreparedScan& scan, const MovingPose& moving,
                  const Sighting& before, double contradiction);

/// How much of two scans in a row cannot have been seen from where they are said to be (0 to 1), whatever a
/// map knows of either: the larger of the shares of the one that the other one says is not there. Some
/// hundredths in streets with traffic, through doors and in shakes; another place that looks the same has
/// 0.15 and more. 0 after more than half a second, in which too much may have changed, and of planar sensors,
/// whose few points say too little.
double contradiction(const Sighting& before, std::int64_t utime, const PreparedScan& scan,
                     const MovingPose& now);

/// Whether that is too much for a scan of the same place.
bool is_elsewhere(const Sighting& before, double contradiction);

}  // namespace scanlock
