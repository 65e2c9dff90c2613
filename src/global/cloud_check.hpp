// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "search/kd_tree.hpp"

namespace scanlock {

/// What two clouds say about a pose between them.
struct CloudFit {
  /// Share of the points of one cloud that lie on a surface of the other that looks the same way: nearer than
  /// half a voxel to its plane. Of the two directions the better one, for one cloud may reach farther. Level
  /// ground, which fits everywhere, is left out where there is anything else.
  double overlap = 0;
  double residual = 0;  ///< metres: median distance of those that are near any surface to its plane
  /// Share of the points in directions into which the other cloud's sensor looked that lie well before what
  /// it saw there: its rays went through them. Of the two directions the worse one.
  double contradiction = 0;
};

/// A described cloud made ready to be compared with others.
class CloudCheck {
 public:
  /// `cloud`: thinned by `voxel` (metres), with normals, its origin the place of (one of) its sensors. Must
  /// outlive this object.
  CloudCheck(const PointCloud& cloud, double voxel);

  friend CloudFit compare(const CloudCheck& source, const CloudCheck& target, const Pose& target_from_source);

 private:
  struct OneWay {
    double overlap = 0, contradiction = 0;
    std::vector<float> distances;
  };
  static OneWay one_way(const CloudCheck& from, const CloudCheck& to, const Pose& to_from_from);

  /// The nearest return in each direction, seen from the origin.
  void draw_ranges();
  static constexpr int kColumns = 120, kRows = 60;
  static int column(const Eigen::Vector3f&p), row(const Eigen::Vector3f&p);

  const PointCloud& cloud_;
  float voxel_;
  KdTree tree_;
  std::vector<std::uint32_t> samples_;
  std::vector<float> ranges_;  // metres, infinite where nothing came back
};

}  // namespace scanlock
