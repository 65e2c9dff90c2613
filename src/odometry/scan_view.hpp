// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"

namespace scanlock {

/// Range image of a scan: the smallest and the largest range in each cell of two degrees and its eight
/// neighbours.
class ScanView {
 public:
  ScanView() = default;
  /// `points` relative to the sensor.
  explicit ScanView(const PointCloud& points);

  /// The share of the points of another scan (in its frame) that this range image contradicts: its rays pass
  /// through the point, or it sees a surface in front of the point that lies in free space of the other range
  /// image. Points that an edge hides or uncovers, and directions without a return in one of the two, are not
  /// counted as contradicted.
  double contradicted_share(const PointCloud& points, const Pose& here_from_there,
                            const ScanView& there) const;

 private:
  struct Reach {
    float nearest, farthest;  ///< metres
    bool known() const { return farthest > 0; }
  };
  bool looks_through(const Eigen::Vector3f& p) const;

  std::vector<Reach> reach_;  ///< in rows of equal elevation; empty without points
};

}  // namespace scanlock
