// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "search/kd_tree.hpp"

namespace scanlock {

/// Exact nearest neighbours in a cloud that grows: FLANN's single tree cannot take points, so what is new
/// goes into a small tree of its own until it is worth building one of all. A search runs through the trees
/// with one bound.
class KdForest {
 public:
  /// Trees over the first `old_points` of the cloud and over the rest.
  void rebuild(const PointCloud& cloud) {
    old_ = KdTree(cloud);
    old_points_ = cloud.size();
    fresh_ = KdTree();
  }
  /// The cloud has grown at its end: indexes what came since the last rebuild.
  void grow(const PointCloud& cloud) { fresh_ = KdTree(cloud, old_points_, cloud.size()); }

  std::size_t old_points() const { return old_points_; }
  std::size_t size() const { return old_.size() + fresh_.size(); }

  /// As in KdTree.
  int k_nearest(const Eigen::Vector3f& query, int k, Neighbour* out,
                float max_distance = std::numeric_limits<float>::infinity()) const {
    return fresh_.add_k_nearest(query, k, old_.k_nearest(query, k, out, max_distance), out, max_distance);
  }

 private:
  KdTree old_, fresh_;
  std::size_t old_points_ = 0;
};

}  // namespace scanlock
