// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/cloud_check.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace scanlock {
namespace {

constexpr std::size_t kSamples = 2500, kFewSteep = 100;
constexpr float kLevel = 0.8f;    // |vertical component of the normal|
constexpr float kNear = 1.5f;     // voxels: a surface sampled a point a voxel has one so near
constexpr float kOn = 0.5f;       // voxels from its plane
constexpr float kSameWay = 0.7f;  // cosine
constexpr float kCell = 1.5f;     // voxels
constexpr float kStandOff = 2;    // cells
constexpr int kMostSteps = 200;

std::vector<std::uint32_t> every_nth(const std::vector<std::uint32_t>& from, std::size_t count) {
  const std::size_t stride = std::max<std::size_t>(1, from.size() / count);
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < from.size(); i += stride) result.push_back(from[i]);
  return result;
}

}  // namespace

CloudCheck::CloudCheck(const PointCloud& cloud, double voxel)
    : cloud_(cloud), voxel_(static_cast<float>(voxel)), tree_(cloud) {
  std::vector<std::uint32_t> steep, all;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    all.push_back(i);
    if (std::abs(cloud.nz[i]) < kLevel && cloud.normal(i).squaredNorm() > 0.5f) steep.push_back(i);
  }
  samples_ = every_nth(steep.size() >= kFewSteep ? steep : all, kSamples);
  trace_rays();
}

Eigen::Vector3d CloudCheck::loose_direction() const {
  Eigen::Matrix2d moment = Eigen::Matrix2d::Zero();
  for (std::uint32_t i : samples_) {
    const Eigen::Vector2d normal = cloud_.normal(i).head<2>().cast<double>();
    moment += normal * normal.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(moment);
  const Eigen::Vector2d least = solver.eigenvectors().col(0);
  return {least.x(), least.y(), 0};
}

Eigen::Array3i CloudCheck::cell(const Eigen::Vector3f& p) const {
  constexpr float kFar = kMostSteps + 1;
  return (p.array() / (kCell * voxel_)).floor().max(-kFar).min(kFar).cast<int>();
}

std::ptrdiff_t CloudCheck::index(const Eigen::Array3i& cell) const {
  const Eigen::Array3i offset = cell - low_;
  if ((offset < 0).any() || (offset >= size_).any()) return -1;
  return (static_cast<std::ptrdiff_t>(offset.z()) * size_.y() + offset.y()) * size_.x() + offset.x();
}

/// No ray is followed farther than kMostSteps, which bounds the cells: 8 MB of bits.
void CloudCheck::trace_rays() {
  const float step = kCell * voxel_;
  Eigen::Array3i high = Eigen::Array3i::Zero();
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    low_ = low_.min(cell(cloud_.point(i)));
    high = high.max(cell(cloud_.point(i)));
  }
  size_ = high - low_ + 1;
  free_.assign(static_cast<std::size_t>(size_.cast<std::ptrdiff_t>().prod()), false);
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    const float range = cloud_.point(i).norm();
    const Eigen::Vector3f direction = cloud_.point(i) / range;
    // The last stretch may graze the surface that the ray ends on.
    const int steps = std::min(static_cast<int>((range - kStandOff * step) / step), kMostSteps);
    for (int k = 1; k < steps; ++k) {
      const std::ptrdiff_t at = index(cell(direction * (step * static_cast<float>(k))));
      if (at >= 0) free_[static_cast<std::size_t>(at)] = true;
    }
  }
}

/// Rays skim over the ground between the few that hit it: where it is free below, too, that is not the
/// ground.
bool CloudCheck::is_free(const Eigen::Vector3f& p) const {
  const auto free = [&](const Eigen::Vector3f& at) {
    const std::ptrdiff_t i = index(cell(at));
    return i >= 0 && free_[static_cast<std::size_t>(i)];
  };
  return free(p) && free(p - Eigen::Vector3f(0, 0, kCell * voxel_));
}

CloudCheck::OneWay CloudCheck::one_way(const CloudCheck& from, const CloudCheck& to,
                                       const Pose& to_from_from) {
  const Eigen::Matrix3f rotation = to_from_from.linear().cast<float>();
  const Eigen::Vector3f translation = to_from_from.translation().cast<float>();
  OneWay result;
  std::size_t on = 0, through = 0;
  for (std::uint32_t i : from.samples_) {
    const Eigen::Vector3f p = rotation * from.cloud_.point(i) + translation;
    const Neighbour nearest = to.tree_.nearest(p, kNear * to.voxel_);
    if (nearest.index < 0) {
      through += to.is_free(p) ? 1 : 0;
      continue;
    }
    const std::size_t j = static_cast<std::size_t>(nearest.index);
    const float distance = std::abs(to.cloud_.normal(j).dot(p - to.cloud_.point(j)));
    const float cosine = to.cloud_.normal(j).dot(rotation * from.cloud_.normal(i));
    result.distances.push_back(distance);
    on += distance < kOn * to.voxel_ && std::abs(cosine) > kSameWay ? 1 : 0;
  }
  if (!from.samples_.empty())
    result.overlap = static_cast<double>(on) / static_cast<double>(from.samples_.size());
  if (on + through > 0)
    result.contradiction = static_cast<double>(through) / static_cast<double>(on + through);
  return result;
}

CloudFit compare(const CloudCheck& source, const CloudCheck& target, const Pose& target_from_source) {
  CloudCheck::OneWay there = CloudCheck::one_way(source, target, target_from_source);
  const CloudCheck::OneWay back = CloudCheck::one_way(target, source, target_from_source.inverse());
  CloudFit fit;
  fit.overlap = std::max(there.overlap, back.overlap);
  fit.least_overlap = std::min(there.overlap, back.overlap);
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
