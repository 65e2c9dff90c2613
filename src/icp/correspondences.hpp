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
/// A search stores the few nearest target points (candidates) and a distance d that all other target points
/// exceed. Once the source point has moved by m, all other points are farther than d - m (triangle
/// inequality): if the nearest candidate is nearer than that, it is the answer; if the gate is, no other
/// point is within the gate. The answers are therefore those of a full search at every update, at lower cost.
class Correspondences {
 public:
  static constexpr int kCandidates = 6;

  /// Clears all stored searches and prepares for `n` source points. The cloud and its tree must outlive the
  /// use of this object. `candidates`, 2 to kCandidates: number of target points that a search stores. With
  /// more, a search costs more, and its answers remain valid for larger motions.
  void reset(const PointCloud& target, const KdForest& tree, std::size_t n, int candidates = kCandidates);

  /// Updates the answers for the moved source (x, y, z of n points each, target frame, metres): the nearest
  /// target point within `gate` metres of each. `threads` does not change the answers.
  void update(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z,
              float gate, int threads);

  /// Index of the nearest target point for each source point; -1: none within the gate. Points somewhat
  /// beyond the gate may be returned, too: the caller computes the distance, which changes with every motion.
  const std::vector<std::int32_t>& indices() const { return indices_; }

  /// Updates the answer for source point i, now at `query` (target frame, metres), and returns it; increments
  /// `searches` if it had to search. Thread-safe for different i. Report the totals to note() afterwards.
  std::int32_t find(std::size_t i, const Eigen::Vector3f& query, float gate, std::int64_t* searches);
  void note(std::int64_t asked, std::int64_t searches) {
    searches_made_ += searches;
    searches_saved_ += asked - searches;
  }
  /// The last answer of find() for source point i.
  std::int32_t found(std::size_t i) const { return memories_[i].answer; }

  std::int64_t searches_made() const { return searches_made_; }
  std::int64_t searches_saved() const { return searches_saved_; }

 private:
  struct Memory {
    float x, y, z;      ///< position at the last search
    float beyond = -1;  ///< metres: all other target points were at least this far; negative: not searched
    float margin = -1;  ///< metres: for motions shorter than this, the nearest candidate stays the nearest
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
