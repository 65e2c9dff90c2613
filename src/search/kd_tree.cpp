// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "search/kd_tree.hpp"

#include <algorithm>
#include <cmath>
#include <flann/flann.hpp>
#include <utility>
#include <vector>

namespace scanlock {
namespace {

/// Squared Euclidean distance in three dimensions, unrolled.
struct SquaredDistance3 {
  using is_kdtree_distance = bool;
  using ElementType = float;
  using ResultType = float;

  template <typename A, typename B>
  float operator()(A a, B b, std::size_t, float = -1) const {
    const float dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
    return dx * dx + dy * dy + dz * dz;
  }
  template <typename U, typename V>
  float accum_dist(const U& a, const V& b, int) const {
    return (a - b) * (a - b);
  }
};

/// The k nearest points so far, sorted. Starts with a known bound, so that the search prunes from its first
/// step.
class BoundedNearest final : public flann::ResultSet<float> {
 public:
  BoundedNearest(Neighbour* out, int capacity, int count, float squared_bound, const std::int32_t* original)
      : out_(out), capacity_(capacity), count_(count), squared_bound_(squared_bound), original_(original) {
    if (count_ == capacity_) squared_bound_ = std::min(squared_bound_, out_[capacity_ - 1].squared_distance);
  }

  bool full() const override { return true; }  // so that FLANN prunes with the bound before k are found
  float worstDist() const override { return squared_bound_; }

  void addPoint(float squared_distance, std::size_t index) override {
    // FLANN has compared with the bound that held when the search entered the leaf.
    if (!(squared_distance < squared_bound_)) return;
    int at = count_ < capacity_ ? count_++ : capacity_ - 1;
    for (; at > 0 && out_[at - 1].squared_distance > squared_distance; --at) out_[at] = out_[at - 1];
    out_[at] = {original_[index], squared_distance};
    if (count_ == capacity_) squared_bound_ = out_[capacity_ - 1].squared_distance;
  }

  int count() const { return count_; }

 private:
  Neighbour* out_;
  int capacity_;
  int count_;
  float squared_bound_;
  const std::int32_t* original_;
};

constexpr int kLeafSize = 24;

}  // namespace

struct KdTree::Index {
  std::vector<float> coordinates;      // three per point; empty once the tree is built
  std::vector<std::int32_t> original;  // index into the caller's cloud
  std::unique_ptr<flann::KDTreeSingleIndex<SquaredDistance3>> tree;
  flann::SearchParams parameters;
  std::size_t size = 0;
};

KdTree::KdTree() : index_(std::make_unique<Index>()) {}

KdTree::KdTree(const PointCloud& cloud, std::size_t begin, std::size_t end) : KdTree() {
  Index& index = *index_;
  index.coordinates.reserve(3 * (end - begin));
  index.original.reserve(end - begin);
  for (std::size_t i = begin; i < end; ++i) {
    if (!std::isfinite(cloud.x[i]) || !std::isfinite(cloud.y[i]) || !std::isfinite(cloud.z[i])) continue;
    index.coordinates.insert(index.coordinates.end(), {cloud.x[i], cloud.y[i], cloud.z[i]});
    index.original.push_back(static_cast<std::int32_t>(i));
  }
  index.size = index.coordinates.size() / 3;
  if (index.size == 0) return;
  flann::Matrix<float> rows(index.coordinates.data(), index.size, 3);
  index.tree = std::make_unique<flann::KDTreeSingleIndex<SquaredDistance3>>(
      rows, flann::KDTreeSingleIndexParams(kLeafSize, true));
  index.tree->buildIndex();
  // Searches read FLANN's own copy of the points, which is in the order of the tree.
  std::vector<float>().swap(index.coordinates);
  // Negative on purpose: FLANN accumulates its lower bounds with float rounding errors, and without this
  // margin could prune a subtree that contains the nearest point.
  index.parameters.eps = -1e-5f;
}

KdTree::~KdTree() = default;
KdTree::KdTree(KdTree&&) noexcept = default;
KdTree& KdTree::operator=(KdTree&&) noexcept = default;

std::size_t KdTree::size() const {
  return index_->size;
}

Neighbour KdTree::nearest(const Eigen::Vector3f& query, float max_distance) const {
  Neighbour result;
  k_nearest(query, 1, &result, max_distance);
  return result;
}

int KdTree::k_nearest(const Eigen::Vector3f& query, int k, Neighbour* out, float max_distance) const {
  return add_k_nearest(query, k, 0, out, max_distance);
}

int KdTree::add_k_nearest(const Eigen::Vector3f& query, int k, int count, Neighbour* out,
                          float max_distance) const {
  const Index& index = *index_;
  if (index.size == 0 || k <= 0 || !query.allFinite() || !(max_distance > 0)) return count;
  BoundedNearest found(out, k, count, max_distance * max_distance, index.original.data());
  index.tree->findNeighbors(found, query.data(), index.parameters);
  return found.count();
}

}  // namespace scanlock
