// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/cloud_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scanlock {
namespace {

constexpr float kPi = 3.14159265f;
constexpr std::size_t kSamples = 2500, kFewSteep = 100;
constexpr float kLevel = 0.8f;        // |vertical component of the normal|
constexpr float kNear = 1.5f;         // voxels: a surface sampled a point a voxel has one so near
constexpr float kOn = 0.5f;           // voxels from its plane
constexpr float kSameWay = 0.7f;      // cosine
constexpr float kWellBefore = 0.85f;  // of the range
constexpr float kUnknown = std::numeric_limits<float>::infinity();

std::vector<std::uint32_t> every_nth(const std::vector<std::uint32_t>& from, std::size_t count) {
  const std::size_t stride = std::max<std::size_t>(1, from.size() / count);
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < from.size(); i += stride) result.push_back(from[i]);
  return result;
}

}  // namespace

CloudCheck::CloudCheck(const PointCloud& cloud, double voxel)
    : cloud_(cloud), voxel_(static_cast<float>(voxel)), tree_(cloud), ranges_(kColumns * kRows, kUnknown) {
  std::vector<std::uint32_t> steep, all;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    all.push_back(i);
    if (std::abs(cloud.nz[i]) < kLevel && cloud.normal(i).squaredNorm() > 0.5f) steep.push_back(i);
  }
  samples_ = every_nth(steep.size() >= kFewSteep ? steep : all, kSamples);
  draw_ranges();
}

int CloudCheck::column(const Eigen::Vector3f& p) {
  return std::clamp(static_cast<int>((std::atan2(p.y(), p.x()) + kPi) / (2 * kPi) * kColumns), 0,
                    kColumns - 1);
}

int CloudCheck::row(const Eigen::Vector3f& p) {
  const float elevation = std::atan2(p.z(), std::hypot(p.x(), p.y()));
  return std::clamp(static_cast<int>((elevation / kPi + 0.5f) * kRows), 0, kRows - 1);
}

void CloudCheck::draw_ranges() {
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    const Eigen::Vector3f p = cloud_.point(i);
    float& range = ranges_[static_cast<std::size_t>(row(p) * kColumns + column(p))];
    range = std::min(range, p.norm());
  }
  // A surface seen at a slant has many ranges within a direction and its neighbours; the nearest counts.
  std::vector<float> nearest = ranges_;
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < kColumns; ++c) {
      float& range = nearest[static_cast<std::size_t>(r * kColumns + c)];
      if (range == kUnknown) continue;
      for (int dr = -1; dr <= 1; ++dr) {
        for (int dc = -1; dc <= 1; ++dc) {
          const int other_row = std::clamp(r + dr, 0, kRows - 1),
                    other_column = (c + dc + kColumns) % kColumns;
          range = std::min(range, ranges_[static_cast<std::size_t>(other_row * kColumns + other_column)]);
        }
      }
    }
  }
  ranges_ = std::move(nearest);
}

CloudCheck::OneWay CloudCheck::one_way(const CloudCheck& from, const CloudCheck& to,
                                       const Pose& to_from_from) {
  const Eigen::Matrix3f rotation = to_from_from.linear().cast<float>();
  const Eigen::Vector3f translation = to_from_from.translation().cast<float>();
  OneWay result;
  std::size_t on = 0, seen = 0, before = 0;
  for (std::uint32_t i : from.samples_) {
    const Eigen::Vector3f p = rotation * from.cloud_.point(i) + translation;
    const Neighbour nearest = to.tree_.nearest(p, kNear * to.voxel_);
    if (nearest.index >= 0) {
      const std::size_t j = static_cast<std::size_t>(nearest.index);
      const float distance = std::abs(to.cloud_.normal(j).dot(p - to.cloud_.point(j)));
      const float cosine = to.cloud_.normal(j).dot(rotation * from.cloud_.normal(i));
      result.distances.push_back(distance);
      on += distance < kOn * to.voxel_ && std::abs(cosine) > kSameWay ? 1 : 0;
    }
    const float range = to.ranges_[static_cast<std::size_t>(row(p) * kColumns + column(p))];
    if (range == kUnknown) continue;
    ++seen;
    before += p.norm() < kWellBefore * range - to.voxel_ ? 1 : 0;
  }
  if (!from.samples_.empty())
    result.overlap = static_cast<double>(on) / static_cast<double>(from.samples_.size());
  if (seen > 0) result.contradiction = static_cast<double>(before) / static_cast<double>(seen);
  return result;
}

CloudFit compare(const CloudCheck& source, const CloudCheck& target, const Pose& target_from_source) {
  CloudCheck::OneWay there = CloudCheck::one_way(source, target, target_from_source);
  const CloudCheck::OneWay back = CloudCheck::one_way(target, source, target_from_source.inverse());
  CloudFit fit;
  fit.overlap = std::max(there.overlap, back.overlap);
  fit.contradiction = std::max(there.contradiction, back.contradiction);
  std::vector<float>& distances = there.distances;
  distances.insert(distances.end(), back.distances.begin(), back.distances.end());
  if (distances.empty()) return fit;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  fit.residual = static_cast<double>(*middle);
  return fit;
}

}  // namespace scanlock
