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
  std::int32_t index = -1;  ///< into the cloud the tree was built from; -1: none
  float squared_distance = std::numeric_limits<float>::infinity();
};

/// Exact nearest neighbours in a fixed cloud: FLANN's KDTreeSingleIndex behind guards, for FLANN crashes on
/// an empty index, answers wrongly when data hold a NaN, and leaves outputs unset when k > n. Queries are
/// const and may run on many threads; equal queries get equal answers, whatever thread asks. A query that is
/// not finite has no neighbours. Keep coordinates near the origin: they are floats.
class KdTree {
 public:
  KdTree();
  /// Copies the coordinates of points [begin, end) of the cloud; points that are not finite are left out, and
  /// there need not be any. Answers are indices into the whole cloud.
  KdTree(const PointCloud& cloud, std::size_t begin, std::size_t end);
  explicit KdTree(const PointCloud& cloud) : KdTree(cloud, 0, cloud.size()) {}
  ~KdTree();
  KdTree(KdTree&&) noexcept;
  KdTree& operator=(KdTree&&) noexcept;

  std::size_t size() const;  ///< indexed points

  /// The nearest point nearer than `max_distance` metres.
  Neighbour nearest(const Eigen::Vector3f& query,
                    float max_distance = std::numeric_limits<float>::infinity()) const;

  /// The `k` nearest nearer than `max_distance`, nearest first, into `out` (room for k). Returns how many
  /// there are.
  int k_nearest(const Eigen::Vector3f& query, int k, Neighbour* out,
                float max_distance = std::numeric_limits<float>::infinity()) const;

  /// The same, joined with `count` neighbours that are in `out` already (from another tree, nearest first).
  int add_k_nearest(const Eigen::Vector3f& query, int k, int count, Neighbour* out, float max_distance) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace scanlock
