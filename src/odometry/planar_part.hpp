// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/rigid.hpp"
#include "global/occupancy_search.hpp"
#include "odometry/recovery.hpp"

namespace scanlock {

/// A part of a map of a planar sensor, prepared for searches by search_occupancy().
class PlanarPart {
 public:
  /// Whether the map is of a planar sensor. Throws PointsUnreadable.
  static bool applies(const SearchTarget& target);

  /// Throws PointsUnreadable.
  explicit PlanarPart(const SearchTarget& target);
  /// The places whose log odds against the best one are less than kBelieved are its runners-up. Counts of
  /// matches are samples of the source, consensus and bounds are log-likelihood ratios in nats.
  RecoveryAnswer find(const RecoveryRequest& request) const;
  double cost_s() const;  ///< estimated seconds of CPU of the preparation

 private:
  PlanarPart(const PointCloud& cloud, const SearchTarget& target, const Pose& level_from_map);

  Pose level_from_map_;  // the plane of the sensor is that of x and y
  OccupancyTarget map_;
};

}  // namespace scanlock
