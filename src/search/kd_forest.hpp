// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "search/kd_tree.hpp"

namespace scanlock {

/// Exact nearest neighbours in a cloud that grows. FLANN's single-index tree does not accept further points,
/// so new points go into a second, small tree until a rebuild over all points pays off. A search visits both
/// trees with one bound.
class KdForest {
 public:
  /// Builds one tree over the whole cloud; the second tree becomes empty.
  void rebuild(const PointCloud& cloud) {
    old_ = KdTree(cloud);
    old_points_ = cloud.size();
    fresh_ = KdTree();
  }
  /// After points were appended to the cloud: indexes those added since the last rebuild().
  void grow(const PointCloud& cloud) { fresh_ = KdTree(cloud, old_points_, cloud.size()); }

  std::size_t old_points() const { return old_points_; }
  std::size_t size() const { return old_.size() + fresh_.size(); }

  /// See KdTree::k_nearest().
  int k_nearest(const Eigen::Vector3f& query, int k, Neighbour* out,
                float max_distance = std::numeric_limits<float>::infinity()) const {
    return fresh_.add_k_nearest(query, k, old_.k_nearest(query, k, out, max_distance), out, max_distance);
  }

 private:
  KdTree old_, fresh_;
  std::size_t old_points_ = 0;
};

}  // namespace scanlock
