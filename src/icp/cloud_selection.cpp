// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/cloud_selection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/voxel_grid.hpp"

namespace scanlock {
namespace {

constexpr std::size_t kSpreadFrom = 8000;
constexpr double kFirstSpread = 0.012;  // of the diagonal
constexpr int kSpreadRounds = 12;
constexpr double kSpreadAim = 1.4, kLeastSpreadStep = 1.2, kMostSpreadStep = 3.0;

}  // namespace

PointCloud thinned(const PointCloud& points, std::size_t count) {
  const std::size_t stride = std::max<std::size_t>(1, points.size() / count);
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < points.size(); i += stride) indices.push_back(static_cast<std::uint32_t>(i));
  return select(points, indices);
}

PointCloud in_level_order(const PointCloud& points) {
  const std::size_t n = points.size();
  std::size_t stride = 1;
  while (2 * stride < n) stride *= 2;
  std::vector<std::uint32_t> indices;
  indices.reserve(n);
  for (std::size_t i = 0; i < n; i += stride) indices.push_back(static_cast<std::uint32_t>(i));
  for (; stride > 1; stride /= 2) {
    for (std::size_t i = stride / 2; i < n; i += stride) indices.push_back(static_cast<std::uint32_t>(i));
  }
  return select(points, indices);
}

std::size_t level_points(std::size_t n, double wanted) {
  std::size_t stride = 1;
  while (static_cast<double>(n) / static_cast<double>(2 * stride) >= wanted) stride *= 2;
  return (n + stride - 1) / stride;
}

PointCloud spread_out(const PointCloud& points, double diagonal, std::size_t count) {
  PointCloud result = thinned(points, kSpreadFrom);
  result.nx.clear();
  result.ny.clear();
  result.nz.clear();
  double voxel = kFirstSpread * diagonal;
  for (int round = 0; result.size() > 2 * count && voxel > 0 && round < kSpreadRounds; ++round) {
    PointCloud next = select(result, thin_by_voxel(result, static_cast<float>(voxel)));
    if (next.size() < count / 2) {  // a small part of the scene has nearly all points
      voxel /= kMostSpreadStep;
      continue;
    }
    result = std::move(next);
    // The number of points left on surfaces falls with the square of the voxel size.
    const double wanted =
        std::sqrt(static_cast<double>(result.size()) / (kSpreadAim * static_cast<double>(count)));
    voxel *= std::clamp(wanted, kLeastSpreadStep, kMostSpreadStep);
  }
  return result;
}

}  // namespace scanlock
