// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/scan_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr int kColumns = 180, kRows = 90;
// Ranges that differ by less than the sum of both are of the same surface.
constexpr float kTolerance = 0.1f;  // of the range
constexpr float kMargin = 0.2f;     // metres
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::size_t cell(int row, int column) {
  return static_cast<std::size_t>(row * kColumns + column);
}

/// The cell of a direction; `p` must not be the origin.
std::size_t cell_of(const Eigen::Vector3f& p, float range) {
  constexpr auto kHalfTurn = static_cast<float>(kPi);
  const float turn = atan2(p.y(), p.x()) / kHalfTurn;                                    // -1 to 1
  const float tilt = asin(std::clamp(p.z() / range, -1.0f, 1.0f)) / (0.5f * kHalfTurn);  // -1 to 1
  const int column = static_cast<int>(0.5f * (turn + 1) * kColumns) % kColumns;
  const int row = std::min(static_cast<int>(0.5f * (tilt + 1) * kRows), kRows - 1);
  return cell(row, column);
}

float surely_before(float range) {
  return range * (1 - kTolerance) - kMargin;
}

float surely_behind(float range) {
  return range * (1 + kTolerance) + kMargin;
}

}  // namespace

ScanView::ScanView(const PointCloud& points) {
  const Reach none{kInfinity, 0};
  const auto extend = [](Reach& reach, const Reach& by) {
    reach.nearest = std::min(reach.nearest, by.nearest);
    reach.farthest = std::max(reach.farthest, by.farthest);
  };
  std::vector<Reach> seen(kRows * kColumns, none);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float range = points.point(i).norm();
    if (range > 0) extend(seen[cell_of(points.point(i), range)], {range, range});
  }
  std::vector<Reach> wide(seen.size(), none);
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      for (int aside : {kColumns - 1, 0, 1})
        extend(wide[cell(row, column)], seen[cell(row, (column + aside) % kColumns)]);
    }
  }
  reach_.assign(seen.size(), none);
  for (int row = 0; row < kRows; ++row) {
    const int below = std::max(row - 1, 0), above = std::min(row + 1, kRows - 1);
    for (int column = 0; column < kColumns; ++column) {
      const std::size_t here = cell(row, column);
      // Between two rings of points there are no beams: a cell with returns above and below takes their
      // ranges.
      const bool between = seen[cell(below, column)].known() && seen[cell(above, column)].known();
      if (!seen[here].known() && !between) continue;
      for (int r : {below, row, above}) extend(reach_[here], wide[cell(r, column)]);
    }
  }
}

bool ScanView::looks_through(const Eigen::Vector3f& p) const {
  const float range = p.norm();
  if (!(range > 0)) return false;
  const Reach& reach = reach_[cell_of(p, range)];
  return reach.known() && range < surely_before(reach.nearest);
}

double ScanView::contradicted_share(const PointCloud& points, const Pose& here_from_there,
                                    const ScanView& there) const {
  if (reach_.empty() || there.reach_.empty() || points.empty()) return 0;
  const Eigen::Matrix3f turn = here_from_there.linear().cast<float>();
  const Eigen::Vector3f way = here_from_there.translation().cast<float>();
  std::size_t contradicted = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p = turn * points.point(i) + way;
    const float range = p.norm();
    if (!(range > 0)) continue;
    const Reach& reach = reach_[cell_of(p, range)];
    if (!reach.known()) continue;
    const auto was_looked_through = [&](float at) {
      const Eigen::Vector3f hides = turn.transpose() * (p * (at / range) - way);
      return there.looks_through(hides);
    };
    const bool before = range < surely_before(reach.nearest);
    const bool hidden = range > surely_behind(reach.farthest);
    if (before || (hidden && was_looked_through(reach.nearest) && was_looked_through(reach.farthest)))
      ++contradicted;
  }
  return static_cast<double>(contradicted) / static_cast<double>(points.size());
}

}  // namespace scanlock
