// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"

namespace scanlock {

/// How far a sensor saw in which direction: the nearest and the farthest that is in a cell of two degrees or
/// in those around it.
class ScanView {
 public:
  ScanView() = default;
  /// `points` as they are from the sensor, which is the origin.
  explicit ScanView(const PointCloud& points);

  /// Of the points that another sensor saw (in its frame), the share that cannot be there, if both saw what
  /// they saw: this one looks through where they are, or what hides them from this one, the other one looked
  /// through. What comes into view, or goes out of it, behind an edge is no contradiction, however far the
  /// two stand apart; nor is what one of them did not look at.
  double contradicted_share(const PointCloud& points, const Pose& here_from_there,
                            const ScanView& there) const;

 private:
  struct Reach {
    float nearest, farthest;  ///< metres
    bool known() const { return farthest > 0; }
  };
  bool looks_through(const Eigen::Vector3f& p) const;

  std::vector<Reach> reach_;  ///< by rows of one elevation; empty: has seen nothing
};

}  // namespace scanlock
