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

// Searches reach somewhat beyond the gate, so that points without a neighbour can move some way before they
// have to be searched again.
constexpr float kSearchBeyondGate = 1.5f;
// Relative rounding error allowed for distances, which are floats.
constexpr float kRounding = 1e-5f;

}  // namespace

void Correspondences::reset(const PointCloud& target, const KdForest& tree, std::size_t n, int candidates) {
  wanted_ = candidates;
  target_ = &target;
  tree_ = &tree;
  Memory none{};
  none.candidates.fill(-1);
  memories_.assign(n, none);
  searches_made_ = searches_saved_ = 0;
}

float Correspondences::squared_distance(std::int32_t index, const Eigen::Vector3f& query) const {
  const std::size_t i = static_cast<std::size_t>(index);
  const float dx = query.x() - target_->x[i], dy = query.y() - target_->y[i], dz = query.z() - target_->z[i];
  return dx * dx + dy * dy + dz * dz;
}

bool Correspondences::answer_from_memory(const Eigen::Vector3f& query, float gate, Memory* memory) const {
  if (memory->beyond < 0) return false;
  const float dx = query.x() - memory->x, dy = query.y() - memory->y, dz = query.z() - memory->z;
  const float squared_move = dx * dx + dy * dy + dz * dz;
  if (squared_move < memory->margin * memory->margin) {
    memory->answer = memory->candidates[0];
    return true;
  }
  const float others = memory->beyond - std::sqrt(squared_move) * (1.0f + kRounding);
  if (!(others > 0)) return false;
  float best = std::numeric_limits<float>::infinity();
  std::int32_t answer = -1;
  for (const std::int32_t candidate : memory->candidates) {
    if (candidate < 0) break;
    const float squared = squared_distance(candidate, query);
    if (squared < best) {
      best = squared;
      answer = candidate;
    }
  }
  if (!(best < others * others || others > gate)) return false;
  memory->answer = answer;
  return true;
}

void Correspondences::search(const Eigen::Vector3f& query, float radius, Memory* memory) const {
  // The candidates of the last search give an upper bound of the distances, so that the search prunes from
  // its first step.
  float bound = radius;
  if (memory->candidates[static_cast<std::size_t>(wanted_ - 1)] >= 0) {
    float farthest = 0;
    for (int k = 0; k < wanted_; ++k)
      farthest = std::max(farthest, squared_distance(memory->candidates[static_cast<std::size_t>(k)], query));
    bound = std::min(bound, std::sqrt(farthest) * (1.0f + kRounding) + std::numeric_limits<float>::min());
  }
  std::array<Neighbour, kCandidates> found;
  const int count = tree_->k_nearest(query, wanted_, found.data(), bound);
  memory->x = query.x();
  memory->y = query.y();
  memory->z = query.z();
  for (int k = 0; k < kCandidates; ++k)
    memory->candidates[static_cast<std::size_t>(k)] =
        k < count ? found[static_cast<std::size_t>(k)].index : -1;
  const float d1 = count > 0 ? std::sqrt(found[0].squared_distance) : bound;
  const float d2 = count > 1 ? std::sqrt(found[1].squared_distance) : bound;
  const float last =
      count == wanted_ ? std::sqrt(found[static_cast<std::size_t>(wanted_ - 1)].squared_distance) : bound;
  memory->beyond = last * (1.0f - kRounding);
  memory->margin = count > 0 ? 0.5f * (d2 - d1) - kRounding * d2 : -1.0f;
  memory->answer = memory->candidates[0];
  if (!(memory->margin > 0)) memory->margin = 0;
}

std::int32_t Correspondences::find(std::size_t i, const Eigen::Vector3f& query, float gate,
                                   std::int64_t* searches) {
  Memory& memory = memories_[i];
  if (!answer_from_memory(query, gate, &memory)) {
    search(query, gate * kSearchBeyondGate, &memory);
    ++*searches;
  }
  return memory.answer;
}

void Correspondences::update(const std::vector<float>& x, const std::vector<float>& y,
                             const std::vector<float>& z, float gate, int threads) {
  const std::size_t n = memories_.size();
  indices_.resize(n);
  std::atomic<std::int64_t> made{0};
  for_each_chunk(n, kChunk, threads, [&](std::size_t begin, std::size_t end) {
    std::int64_t made_here = 0;
    for (std::size_t i = begin; i < end; ++i) indices_[i] = find(i, {x[i], y[i], z[i]}, gate, &made_here);
    made += made_here;
  });
  note(static_cast<std::int64_t>(n), made);
}

}  // namespace scanlock
