// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "search/kd_forest.hpp"

namespace scanlock {

/// Nearest target points of a moving source, searched again only where the answer can have changed.
///
/// With d1 and d2 the distances to the nearest and second nearest target point when a source point was last
/// searched, its nearest neighbour is the same as long as it has moved by less than (d2 - d1) / 2 since
/// (triangle inequality), and a point with no neighbour within r has none within g < r as long as it has
/// moved by less than r - g. So the answers are those of a search of every point at every update; only the
/// work is less.
class Correspondences {
 public:
  /// Forgets everything and prepares for `n` source points. Cloud and its tree must outlive this object's
  /// use.
  void reset(const PointCloud& target, const KdForest& tree, std::size_t n);

  /// Brings the answers up to date with the moved source (x, y, z of n points each, target frame, metres):
  /// the nearest target point within `gate` metres of each. `threads` does not change the answers.
  void update(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z,
              float gate, int threads);

  /// Index of the nearest target point; -1: there is none within the gate. One somewhat beyond the gate may
  /// be named too: the distance, which changes with every move, is the caller's to compute.
  const std::vector<std::int32_t>& indices() const { return indices_; }

  std::int64_t searches_made() const { return searches_made_; }
  std::int64_t searches_saved() const { return searches_saved_; }

 private:
  struct Memory {
    float x, y, z;      ///< position at the last search
    float margin = -1;  ///< how far the point may move before it is searched again; negative: never searched
    std::int32_t nearest = -1, second = -1;
  };
  bool answer_holds(const Memory& memory, float x, float y, float z) const;
  void search(const Eigen::Vector3f& query, float radius, float gate, Memory* memory) const;

  const PointCloud* target_ = nullptr;
  const KdForest* tree_ = nullptr;
  float gate_ = 0;
  std::vector<Memory> memories_;
  std::vector<std::int32_t> indices_;
  std::int64_t searches_made_ = 0, searches_saved_ = 0;
};

}  // namespace scanlock
