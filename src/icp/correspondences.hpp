// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "search/kd_forest.hpp"

namespace scanlock {

/// Nearest target points of a moving source, searched again only where the answer can have changed.
///
/// A search keeps a few nearest target points, and with them a distance that all others are beyond. Once the
/// source point has moved by m, all others are beyond that distance less m (triangle inequality): as long as
/// the nearest of the few is nearer, it is the answer, and as long as the gate is nearer, there is none. So
/// the answers are those of a search of every point at every update; only the work is less.
class Correspondences {
 public:
  static constexpr int kCandidates = 6;

  /// Forgets everything and prepares for `n` source points. Cloud and its tree must outlive this object's
  /// use. `candidates`, 2 to kCandidates: how many target points a search keeps. More make a search dearer,
  /// and more of its answers last.
  void reset(const PointCloud& target, const KdForest& tree, std::size_t n, int candidates = kCandidates);

  /// Brings the answers up to date with the moved source (x, y, z of n points each, target frame, metres):
  /// the nearest target point within `gate` metres of each. `threads` does not change the answers.
  void update(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z,
              float gate, int threads);

  /// Index of the nearest target point; -1: there is none within the gate. One somewhat beyond the gate may
  /// be named too: the distance, which changes with every move, is the caller's to compute.
  const std::vector<std::int32_t>& indices() const { return indices_; }

  /// The same for one source point, which is now at `query`; returns its answer and adds to `searches` what
  /// it took. May run at the same time for different points; tell note() about the work when done.
  std::int32_t find(std::size_t i, const Eigen::Vector3f& query, float gate, std::int64_t* searches);
  void note(std::int64_t asked, std::int64_t searches) {
    searches_made_ += searches;
    searches_saved_ += asked - searches;
  }
  /// What find() answered last.
  std::int32_t found(std::size_t i) const { return memories_[i].answer; }

  std::int64_t searches_made() const { return searches_made_; }
  std::int64_t searches_saved() const { return searches_saved_; }

 private:
  struct Memory {
    float x, y, z;      ///< position at the last search
    float beyond = -1;  ///< no other target point was nearer than this; negative: never searched
    float margin = -1;  ///< as long as the point has moved by less, the nearest candidate stays the nearest
    std::int32_t answer = -1;
    std::array<std::int32_t, kCandidates> candidates{};  ///< nearest first; -1: none
  };
  void search(const Eigen::Vector3f& query, float radius, Memory* memory) const;
  bool answer_from_memory(const Eigen::Vector3f& query, float gate, Memory* memory) const;
  float squared_distance(std::int32_t index, const Eigen::Vector3f& query) const;

  const PointCloud* target_ = nullptr;
  const KdForest* tree_ = nullptr;
  int wanted_ = kCandidates;
  std::vector<Memory> memories_;
  std::vector<std::int32_t> indices_;
  std::int64_t searches_made_ = 0, searches_saved_ = 0;
};

}  // namespace scanlock
