// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/cloud_target.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/parallel.hpp"
#include "geometry/radix_sort.hpp"
#include "geometry/voxel_grid.hpp"
#include "icp/local_surfaces.hpp"

namespace scanlock {
namespace {

// Scales are medians: 1024 points spread over the cloud determine them to a few percent.
constexpr std::size_t kScaleSamples = 1024;
// A nu below these shares of the diagonal or of the spacing would only fit float rounding.
constexpr double kLeastNuOfDiagonal = 1e-6;
constexpr double kLeastNuOfSpacing = 0.01;

/// For an even number of values, the mean of the middle two; 0 for none. Reorders the values.
float median(std::vector<float>* values) {
  if (values->empty()) return 0;
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return values->size() % 2 == 1 ? *middle : 0.5f * (*middle + *std::max_element(values->begin(), middle));
}

/// Points in Morton order, which keeps neighbours together, so that successive searches use the same parts of
/// the tree, in cache.
PointCloud in_morton_order(PointCloud points, double diagonal) {
  const float cells = diagonal > 0 ? static_cast<float>(1024.0 / diagonal) : 0.0f;
  std::vector<KeyedIndex> order(points.size());
  // Counted from a corner of a cube around the cloud, so that keys differ in few digits.
  const auto cell = [&](float v) { return static_cast<std::int32_t>(v * cells + 512.0f); };
  for (std::size_t i = 0; i < points.size(); ++i) {
    order[i] = {morton_key(cell(points.x[i]), cell(points.y[i]), cell(points.z[i])),
                static_cast<std::uint32_t>(i)};
  }
  if (std::is_sorted(order.begin(), order.end())) return points;
  radix_sort(&order);
  std::vector<std::uint32_t> indices(order.size());
  std::transform(order.begin(), order.end(), indices.begin(), [](const auto& entry) { return entry.second; });
  return select(points, indices);
}

bool normalise_own_normal(PointCloud* cloud, std::size_t i) {
  const Eigen::Vector3f n = cloud->normal(i);
  const float length = n.norm();
  if (!(length > 1e-6f && length < 1e6f)) return false;
  cloud->nx[i] = n.x() / length;
  cloud->ny[i] = n.y() / length;
  cloud->nz[i] = n.z() / length;
  return true;
}

}  // namespace

void estimate_normals(PointCloud* cloud, const KdForest& tree, int neighbours, int threads,
                      const Eigen::Vector3f* viewpoint) {
  const std::size_t n = cloud->size();
  for (std::vector<float>* values : {&cloud->nx, &cloud->ny, &cloud->nz}) values->resize(n, 0.0f);
  for_each_chunk(n, kChunk, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbour> found(static_cast<std::size_t>(neighbours));
    for (std::size_t i = begin; i < end; ++i) {
      if (normalise_own_normal(cloud, i)) continue;
      const int count = tree.k_nearest(cloud->point(i), neighbours, found.data());
      const Surface surface = fit_surface(*cloud, found.data(), count);
      Eigen::Vector3f normal = surface.weight > 0 ? surface.normal : Eigen::Vector3f(0, 0, 0);
      if (viewpoint && normal.dot(*viewpoint - cloud->point(i)) < 0) normal = -normal;
      cloud->nx[i] = normal.x();
      cloud->ny[i] = normal.y();
      cloud->nz[i] = normal.z();
    }
  });
}

CentredCloud centred(const PointCloud& cloud) {
  CentredCloud result;
  Eigen::Array3d low = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  std::size_t finite = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.point(i).allFinite()) continue;
    ++finite;
    low = low.min(cloud.point(i).cast<double>().array());
    high = high.max(cloud.point(i).cast<double>().array());
  }
  if (finite == 0) return result;
  result.centre = 0.5 * (low + high);
  result.diagonal = (high - low).matrix().norm();
  PointCloud& points = result.points;
  points.reserve(finite);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.point(i).allFinite()) continue;
    points.push_back(Eigen::Vector3f((cloud.point(i).cast<double>() - result.centre).cast<float>()));
    if (!cloud.has_normals()) continue;
    points.nx.push_back(cloud.nx[i]);
    points.ny.push_back(cloud.ny[i]);
    points.nz.push_back(cloud.nz[i]);
  }
  points = in_morton_order(std::move(points), result.diagonal);
  return result;
}

/// Median over the samples of the median of distance(point, neighbour) over the neighbours of a sample.
template <typename Distance>
double CloudTarget::median_over_samples(const Distance& distance) const {
  std::vector<float> medians, distances;
  for (const Sample& sample : samples_) {
    distances.clear();
    for (int k = 0; k < sample.count; ++k) distances.push_back(distance(sample.point, sample.neighbours[k]));
    medians.push_back(median(&distances));
  }
  return static_cast<double>(median(&medians));
}

CloudTarget::CloudTarget(const PointCloud& cloud, int threads) : cloud_(centred(cloud)) {
  const PointCloud& points = cloud_.points;
  if (points.size() < 3) {
    throw std::invalid_argument(std::to_string(points.size()) +
                                " finite points; an alignment takes at least 3");
  }
  tree_.rebuild(points);
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kScaleSamples);
  samples_.resize((points.size() + stride - 1) / stride);
  for_each_chunk(samples_.size(), kChunk, threads, [&](std::size_t begin, std::size_t end) {
    Neighbour found[Sample::kNeighbours + 1];
    for (std::size_t s = begin; s < end; ++s) {
      // The first neighbour found is the point itself, at distance 0.
      const int count = tree_.k_nearest(points.point(s * stride), Sample::kNeighbours + 1, found);
      samples_[s].point = s * stride;
      samples_[s].count = count - 1;
      for (int k = 1; k < count; ++k)
        samples_[s].neighbours[k - 1] = static_cast<std::size_t>(found[k].index);
    }
  });
  spacing_ = median_over_samples(
      [&](std::size_t i, std::size_t k) { return (points.point(k) - points.point(i)).norm(); });
  point_nu_min_ = std::max(spacing_ / (3.0 * std::sqrt(3.0)), least_nu());
}

double CloudTarget::least_nu() const {
  return std::max(kLeastNuOfDiagonal * cloud_.diagonal, 1e-12);
}

void CloudTarget::prepare_normals(int threads, const Eigen::Vector3d* viewpoint, int neighbours) {
  const Eigen::Vector3f from =
      viewpoint ? Eigen::Vector3f((*viewpoint - cloud_.centre).cast<float>()) : Eigen::Vector3f::Zero();
  estimate_normals(&cloud_.points, tree_, neighbours, threads, viewpoint ? &from : nullptr);
  normals_ready_ = true;
  const PointCloud& points = cloud_.points;
  const double height = median_over_samples([&](std::size_t i, std::size_t k) {
    return std::abs(points.normal(i).dot(points.point(k) - points.point(i)));
  });
  plane_nu_min_ = std::max({height / 6.0, least_nu(), kLeastNuOfSpacing * spacing_});
}

}  // namespace scanlock
