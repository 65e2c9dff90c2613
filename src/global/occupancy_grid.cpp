// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/occupancy_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace scanlock {
namespace {

constexpr float kStandOff = 1.5f;  // cells: the end of a ray may graze the surface that it ends on

Eigen::Array2i cell_of(const Eigen::Vector2f& p, double cell) {
  constexpr float kFar = OccupancyGrid::kMostCells + 1;
  return (p.array() / static_cast<float>(cell)).floor().max(-kFar).min(kFar).cast<int>();
}

}  // namespace

OccupancyGrid::OccupancyGrid(const PointCloud& cloud, double cell) : cell_(std::max(cell, 1e-3)) {
  Eigen::Array2i high = Eigen::Array2i::Zero();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (const Eigen::Vector3f& p : {cloud.point(i), cloud.eye(i)}) {
      low_ = low_.min(cell_of(p.head<2>(), cell_));
      high = high.max(cell_of(p.head<2>(), cell_));
    }
  }
  low_ = low_.max(-kMostCells);
  size_ = high.min(kMostCells) - low_ + 1;
  counts_.resize(static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()));
  std::vector<std::uint32_t> order(cloud.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto eye = [&](std::uint32_t i) { return std::pair(cloud.eye(i).x(), cloud.eye(i).y()); };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return eye(a) < eye(b); });
  std::uint32_t scans = 0;
  for (auto begin = order.begin(); begin != order.end();) {
    const auto end = std::find_if(begin, order.end(), [&](std::uint32_t i) { return eye(i) != eye(*begin); });
    add_scan(cloud, {begin, end}, ++scans);
    begin = end;
  }
}

std::ptrdiff_t OccupancyGrid::index(const Eigen::Array2i& cell) const {
  const Eigen::Array2i offset = cell - low_;
  if ((offset < 0).any() || (offset >= size_).any()) return -1;
  return static_cast<std::ptrdiff_t>(offset.y()) * size_.x() + offset.x();
}

/// Each cell is counted once: as an end where a ray of the scan ends in it.
void OccupancyGrid::add_scan(const PointCloud& cloud, const std::vector<std::uint32_t>& points,
                             std::uint32_t number) {
  constexpr auto kMost = std::numeric_limits<std::uint16_t>::max();
  const auto count = [&](const Eigen::Array2i& cell, std::uint16_t Counts::*what) {
    const std::ptrdiff_t at = index(cell);
    if (at < 0) return;
    Counts& counts = counts_[static_cast<std::size_t>(at)];
    if (counts.last == number) return;
    counts.last = number;
    if (counts.*what < kMost) ++(counts.*what);
  };
  for (const std::uint32_t i : points) count(cell_of(cloud.point(i).head<2>(), cell_), &Counts::ended);
  const Eigen::Vector2f from = cloud.eye(points.front()).head<2>();
  for (const std::uint32_t i : points) {
    const Eigen::Vector2f way = cloud.point(i).head<2>() - from;
    const float cells = way.norm() / static_cast<float>(cell_);
    const int steps = static_cast<int>(std::min(cells - kStandOff, 2.0f * kMostCells));
    for (int k = 0; k < steps; ++k)
      count(cell_of(from + static_cast<float>(k) / cells * way, cell_), &Counts::passed);
  }
}

OccupancyGrid::State OccupancyGrid::state(int x, int y) const {
  const Counts& counts = counts_[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.x()) +
                                 static_cast<std::size_t>(x)];
  if (2 * counts.ended > counts.passed) return kOccupied;
  return counts.passed > 0 ? kFree : kUnknown;
}

}  // namespace scanlock
