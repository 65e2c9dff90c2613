// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "global/cell_set.hpp"
#include "search/kd_tree.hpp"

namespace scanlock {

/// What two clouds say about a pose between them.
struct CloudFit {
  /// Share of the points of one cloud that lie on a surface of the other that looks the same way: nearer than
  /// half a voxel to its plane. Of the two directions the better one, for one cloud may reach farther. Level
  /// ground, which fits everywhere, is left out where there is anything else.
  double overlap = 0;
  double residual = 0;  ///< metres: median distance of those that are near any surface to its plane
  /// Of the points that lie on a surface of the other cloud or in space that its rays crossed, the share of
  /// the latter. Of the two directions the worse one.
  double contradiction = 0;
  double least_overlap = 0;  ///< as overlap, of the two directions the worse one
};

/// A described cloud made ready to be compared with others.
class CloudCheck {
 public:
  /// `cloud`: thinned by `voxel` (metres), with normals, its origin the place of its sensor, or of one of
  /// them. Must outlive this object.
  CloudCheck(const PointCloud& cloud, double voxel);

  friend CloudFit compare(const CloudCheck& source, const CloudCheck& target, const Pose& target_from_source);

 private:
  struct OneWay {
    double overlap = 0, contradiction = 0;
    std::vector<float> distances;
  };
  static OneWay one_way(const CloudCheck& from, const CloudCheck& to, const Pose& to_from_from);

  /// Marks what the rays from the origin to the points crossed.
  void trace_rays();
  bool is_free(const Eigen::Vector3f& p) const;
  std::uint64_t cell(const Eigen::Vector3f& p) const;

  const PointCloud& cloud_;
  float voxel_;
  KdTree tree_;
  std::vector<std::uint32_t> samples_;
  CellSet free_;
};

}  // namespace scanlock
