// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>

#include "geometry/point_cloud.hpp"

namespace scanlock {

struct Neighbour {
  std::int32_t index = -1;  ///< in the cloud from which the tree was built; -1: none
  float squared_distance = std::numeric_limits<float>::infinity();
};

/// Exact nearest neighbours in a fixed cloud: FLANN's KDTreeSingleIndex with input checks, because FLANN
/// crashes on an empty index, returns wrong results when the data contain a NaN, and leaves outputs unset
/// when k > n. Queries are const and may run in several threads; equal queries give equal results in any
/// thread. A query that is not finite has no neighbours. Coordinates are floats: keep them near the origin.
class KdTree {
 public:
  KdTree();
  /// Copies the coordinates of points [begin, end) of the cloud, except points that are not finite; the range
  /// may be empty. Results are indices into the whole cloud.
  KdTree(const PointCloud& cloud, std::size_t begin, std::size_t end);
  explicit KdTree(const PointCloud& cloud) : KdTree(cloud, 0, cloud.size()) {}
  ~KdTree();
  KdTree(KdTree&&) noexcept;
  KdTree& operator=(KdTree&&) noexcept;

  std::size_t size() const;  ///< indexed points

  /// The nearest point at less than `max_distance` metres; index -1 when there is none.
  Neighbour nearest(const Eigen::Vector3f& query,
                    float max_distance = std::numeric_limits<float>::infinity()) const;

  /// Writes the `k` nearest points at less than `max_distance` metres into `out` (room for k), nearest first.
  /// Returns their number, which may be less than k.
  int k_nearest(const Eigen::Vector3f& query, int k, Neighbour* out,
                float max_distance = std::numeric_limits<float>::infinity()) const;

  /// As k_nearest(), merged with `count` neighbours already in `out` (from another tree, nearest first).
  int add_k_nearest(const Eigen::Vector3f& query, int k, int count, Neighbour* out, float max_distance) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace scanlock
