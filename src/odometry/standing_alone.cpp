// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/standing_alone.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scanlock {
namespace {

constexpr float kSteepest = 0.5f;  // tangent of an elevation: steeper points are not compared
// Cells: in elevation finer than the beams of a sensor are apart, in azimuth as fine as its steps.
constexpr int kImageRows = 192, kImageColumns = 1536;
constexpr float kNothing = std::numeric_limits<float>::infinity();
constexpr float kTurn = 6.2831853f;
constexpr int kWidestStep = 12;  // cells (2.8 degrees): no sensor has a wider step in azimuth

/// The nearest range in each direction.
class RangeImage {
 public:
  RangeImage(const PointCloud& points, const std::vector<std::uint32_t>& indices)
      : nearest_(static_cast<std::size_t>(kImageRows) * kImageColumns, kNothing) {
    for (const std::uint32_t i : indices) {
      const Direction d = direction(points.x[i], points.y[i], points.z[i]);
      if (d.row < 0) continue;
      float& nearest = nearest_[index(d.row, d.column)];
      nearest = std::min(nearest, d.range);
    }
  }

  struct Direction {
    int row, column;
    float range;  ///< horizontal, metres
  };

  /// `row` is negative where the elevation is too steep.
  static Direction direction(float x, float y, float z) {
    const float range = std::sqrt(x * x + y * y), slope = z / range;
    if (!(std::abs(slope) < kSteepest)) return {-1, 0, range};
    // Grows with the azimuth, from 0 to 4, nearly in proportion to it.
    const float along = std::abs(x) + std::abs(y);
    const float turn = y >= 0 ? 1 - x / along : 3 + x / along;
    return {std::min(static_cast<int>((slope + kSteepest) * (kImageRows / (2 * kSteepest))), kImageRows - 1),
            std::min(static_cast<int>(turn * (kImageColumns / 4)), kImageColumns - 1), range};
  }

  /// The nearest range `cells` beside a direction; kNothing where there is no return.
  float beside(const Direction& d, int cells) const {
    const int column = (d.column + cells + kImageColumns) % kImageColumns;
    float nearest = kNothing;
    for (int row = std::max(d.row - 1, 0); row <= std::min(d.row + 1, kImageRows - 1); ++row)
      nearest = std::min(nearest, nearest_[index(row, column)]);
    return nearest;
  }

 private:
  static std::size_t index(int row, int column) {
    return static_cast<std::size_t>(row) * kImageColumns + static_cast<std::size_t>(column);
  }

  std::vector<float> nearest_;
};

/// Cells from a point to the next return beside it: the step of the sensor in azimuth.
int step_beside(const RangeImage& image, const RangeImage::Direction& d) {
  int step = 1;
  while (step <= kWidestStep && image.beside(d, step) == kNothing) ++step;
  return step;
}

/// Whether ranges become larger, or returns end, within `reach` metres on that side of a direction.
/// `empty_is_free`: kWidestStep cells without a return mean free space.
bool is_free(const RangeImage& image, const RangeImage::Direction& d, int side, float reach,
             bool empty_is_free) {
  const float cell = kTurn / kImageColumns * d.range;  // metres, about
  if (reach > kImageColumns / 4 * cell) return false;  // so near the sensor, `reach` is over a quarter turn
  // Most points that are not isolated are recognised by the range just beyond `reach`.
  if (image.beside(d, side * (static_cast<int>(reach / cell) + 1)) < d.range + reach) return false;
  float last = d.range;
  for (int at = 1, empty = 0; empty < kWidestStep; ++at) {
    const float nearest = image.beside(d, side * at);
    if (nearest == kNothing) {
      ++empty;
      continue;
    }
    if (nearest > last + reach) return true;
    if (nearest < d.range - reach || static_cast<float>(at) * cell > reach) return false;
    empty = 0;
    last = nearest;
  }
  return empty_is_free;
}

}  // namespace

std::vector<std::uint8_t> standing_alone(const PointCloud& points, const std::vector<std::uint32_t>& indices,
                                         const PointCloud& some, float reach) {
  const RangeImage image(points, indices);
  std::vector<RangeImage::Direction> directions;
  std::vector<int> steps;
  for (std::size_t i = 0; i < some.size(); ++i) {
    directions.push_back(RangeImage::direction(some.x[i], some.y[i], some.z[i]));
    if (directions.back().row >= 0) steps.push_back(step_beside(image, directions.back()));
  }
  if (steps.empty()) return std::vector<std::uint8_t>(some.size());
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const bool empty_is_free = 3 * *middle <= kWidestStep;
  std::vector<std::uint8_t> alone(some.size());
  for (std::size_t i = 0; i < some.size(); ++i) {
    const auto free = [&](int side) { return is_free(image, directions[i], side, reach, empty_is_free); };
    alone[i] = directions[i].row >= 0 && free(1) && free(-1);
  }
  return alone;
}

}  // namespace scanlock
