// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/cloud_check.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/symmetric_eigen.hpp"
#include "global/cloud_normals.hpp"
#include "global/surface_fit.hpp"

namespace scanlock {
namespace {

constexpr std::size_t kSamples = 2500;
constexpr float kNear = 1.5f;  // voxels: a surface with one point per voxel has a point within this distance
constexpr float kOn = 0.5f;    // voxels from the plane of a surface

std::vector<std::uint32_t> every_nth(const std::vector<std::uint32_t>& from, std::size_t count) {
  const std::size_t stride = std::max<std::size_t>(1, from.size() / count);
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < from.size(); i += stride) result.push_back(from[i]);
  return result;
}

double share(std::size_t part, std::size_t all) {
  return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : 0;
}

}  // namespace

CloudCheck::CloudCheck(const PointCloud& cloud, double voxel)
    : cloud_(cloud), voxel_(static_cast<float>(voxel)), tree_(cloud), space_(cloud, voxel_) {
  std::vector<std::uint32_t> steep, all;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    all.push_back(i);
    if (is_steep(cloud, i)) steep.push_back(i);
  }
  samples_ = every_nth(steep.size() >= kFewSteep ? steep : all, kSamples);
  for (std::uint32_t i : samples_) moved_.push_back(space_.is_crossed(cloud.point(i), cloud.normal(i)));
}

Eigen::Vector3d CloudCheck::loose_direction() const {
  Eigen::Matrix2d moment = Eigen::Matrix2d::Zero();
  for (std::uint32_t i : samples_) {
    const Eigen::Vector2d normal = cloud_.normal(i).head<2>().cast<double>();
    moment += normal * normal.transpose();
  }
  const Eigen::Vector2d least = symmetric_eigen(moment).vectors.col(0);
  return {least.x(), least.y(), 0};
}

bool CloudCheck::contradicts(const CloudCheck& from, std::size_t sample, const Eigen::Vector3f& p,
                             const Eigen::Matrix3f& rotation) const {
  return !from.moved_[sample] && space_.is_crossed(p, rotation * from.cloud_.normal(from.samples_[sample]));
}

double CloudCheck::OneWay::crossed() const {
  return share(through, through + distances.size());
}

CloudCheck::OneWay CloudCheck::one_way(const CloudCheck& from, const CloudCheck& to,
                                       const Pose& to_from_from) {
  const Eigen::Matrix3f rotation = to_from_from.linear().cast<float>();
  const Eigen::Vector3f translation = to_from_from.translation().cast<float>();
  OneWay result;
  std::size_t on = 0, through = 0, steep = 0, above = 0;
  for (std::size_t k = 0; k < from.samples_.size(); ++k) {
    const std::uint32_t i = from.samples_[k];
    const Eigen::Vector3f p = rotation * from.cloud_.point(i) + translation;
    const Neighbour nearest = to.tree_.nearest(p, kNear * to.voxel_);
    if (nearest.index < 0) {
      const bool contradicts = to.contradicts(from, k, p, rotation);
      through += contradicts ? 1 : 0;
      above += !contradicts && to.space_.is_above(p) ? 1 : 0;
      steep += contradicts && is_steep(from.cloud_, i) ? 1 : 0;
      continue;
    }
    const std::size_t j = static_cast<std::size_t>(nearest.index);
    const float distance = std::abs(to.cloud_.normal(j).dot(p - to.cloud_.point(j)));
    const float cosine = to.cloud_.normal(j).dot(rotation * from.cloud_.normal(i));
    result.distances.push_back(distance);
    const bool fits = distance < kOn * to.voxel_ && std::abs(cosine) > kSameWay;
    on += fits ? 1 : 0;
    steep += fits && is_steep(from.cloud_, i) ? 1 : 0;
  }
  const std::size_t all = from.samples_.size();
  result.overlap = share(on, std::max(all - above, std::min(all, kFewSteep)));
  result.on = on;
  result.through = through;
  result.steep = steep;
  return result;
}

CloudFit coarse_fit(const CloudCheck& source, const CloudCheck& target, const Pose& target_from_source,
                    std::size_t count) {
  const Eigen::Matrix3f rotation = target_from_source.linear().cast<float>();
  const Eigen::Vector3f translation = target_from_source.translation().cast<float>();
  const std::size_t stride = std::max<std::size_t>(1, source.samples_.size() / count);
  std::size_t on = 0, through = 0, all = 0;
  for (std::size_t k = 0; k < source.samples_.size(); k += stride, ++all) {
    const Eigen::Vector3f p = rotation * source.cloud_.point(source.samples_[k]) + translation;
    if (target.space_.has_surface(p)) {
      ++on;
    } else if (target.contradicts(source, k, p, rotation)) {
      ++through;
    }
  }
  CloudFit fit;
  fit.overlap = share(on, all);
  fit.contradiction = share(through, on + through);
  return fit;
}

std::vector<std::uint16_t> surfaces_met(const CloudCheck& source, const CloudCheck& target,
                                        const Eigen::Matrix3d& attitude,
                                        const std::vector<Eigen::Vector3d>& places, std::size_t count) {
  std::vector<Eigen::Vector3f> points;
  for (std::uint32_t i : every_nth(source.samples_, count))
    points.push_back(attitude.cast<float>() * source.cloud_.point(i));
  std::vector<std::uint16_t> met;
  met.reserve(places.size());
  for (const Eigen::Vector3d& place : places) {
    const Eigen::Vector3f p = place.cast<float>();
    const auto meets = [&](const Eigen::Vector3f& point) { return target.space_.has_surface(point + p); };
    met.push_back(static_cast<std::uint16_t>(std::count_if(points.begin(), points.end(), meets)));
  }
  return met;
}

CloudFit compare(const CloudCheck& source, const CloudCheck& target, const Pose& target_from_source,
                 ContradictionOf whose) {
  CloudCheck::OneWay there = CloudCheck::one_way(source, target, target_from_source);
  const CloudCheck::OneWay back = CloudCheck::one_way(target, source, target_from_source.inverse());
  CloudFit fit;
  fit.overlap = std::max(there.overlap, back.overlap);
  fit.least_overlap = std::min(there.overlap, back.overlap);
  fit.steep = there.steep + back.steep;
  fit.missing = back.crossed();
  if (whose == ContradictionOf::kSource)
    fit.contradiction = there.crossed();
  else
    fit.contradiction =
        std::max(share(there.through, there.compared()), share(back.through, back.compared()));
  std::vector<float>& distances = there.distances;
  distances.insert(distances.end(), back.distances.begin(), back.distances.end());
  if (distances.empty()) return fit;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  fit.residual = static_cast<double>(*middle);
  return fit;
}

}  // namespace scanlock
