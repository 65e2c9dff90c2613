// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/correspondences.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "geometry/parallel.hpp"

namespace scanlock {
namespace {

constexpr std::size_t kChunk = 256;
// Searching somewhat beyond the gate buys room for points without a neighbour to move before they are
// searched again.
constexpr float kSearchBeyondGate = 1.5f;
// Distances are floats: what they say is trusted only up to this share.
constexpr float kRounding = 1e-5f;

}  // namespace

void Correspondences::reset(const PointCloud& target, const KdForest& tree, std::size_t n) {
  target_ = &target;
  tree_ = &tree;
  gate_ = 0;
  memories_.assign(n, Memory{0, 0, 0, -1, -1, -1});
  indices_.assign(n, -1);
  searches_made_ = searches_saved_ = 0;
}

bool Correspondences::answer_holds(const Memory& memory, float x, float y, float z) const {
  const float dx = x - memory.x, dy = y - memory.y, dz = z - memory.z;
  return memory.margin > 0 && dx * dx + dy * dy + dz * dz < memory.margin * memory.margin;
}

void Correspondences::search(const Eigen::Vector3f& query, float radius, float gate, Memory* memory) const {
  // The two points found last time bound the two distances sought now, so the search prunes from its first
  // step.
  float bound = radius;
  if (memory->second >= 0) {
    const float a = (target_->point(static_cast<std::size_t>(memory->nearest)) - query).norm();
    const float b = (target_->point(static_cast<std::size_t>(memory->second)) - query).norm();
    bound = std::min(bound, std::max(a, b) * (1.0f + kRounding) + std::numeric_limits<float>::min());
  }
  Neighbour found[2];
  const int count = tree_->k_nearest(query, 2, found, bound);
  const float d1 = count > 0 ? std::sqrt(found[0].squared_distance) : radius;
  const float d2 = count > 1 ? std::sqrt(found[1].squared_distance) : radius;
  memory->x = query.x();
  memory->y = query.y();
  memory->z = query.z();
  memory->nearest = count > 0 ? found[0].index : -1;
  memory->second = count > 1 ? found[1].index : -1;
  memory->margin = (count > 0 ? 0.5f * (d2 - d1) : radius - gate) - kRounding * d2;
}

void Correspondences::update(const std::vector<float>& x, const std::vector<float>& y,
                             const std::vector<float>& z, float gate, int threads) {
  const std::size_t n = memories_.size();
  // A wider gate than before makes "none within the radius" worthless; a narrower one only makes it stronger.
  if (gate > gate_) {
    for (Memory& memory : memories_) {
      if (memory.nearest < 0) memory.margin = -1;
    }
  }
  gate_ = gate;
  const float radius = gate * kSearchBeyondGate;
  std::atomic<std::int64_t> made{0};
  for_each_chunk(n, kChunk, threads, [&](std::size_t begin, std::size_t end) {
    std::int64_t made_here = 0;
    for (std::size_t i = begin; i < end; ++i) {
      Memory& memory = memories_[i];
      if (!answer_holds(memory, x[i], y[i], z[i])) {
        search({x[i], y[i], z[i]}, radius, gate, &memory);
        ++made_here;
      }
      indices_[i] = memory.nearest;
    }
    made += made_here;
  });
  searches_made_ += made;
  searches_saved_ += static_cast<std::int64_t>(n) - made;
}

}  // namespace scanlock
