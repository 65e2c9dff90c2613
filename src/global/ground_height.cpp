// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/ground_height.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "geometry/voxel_grid.hpp"
#include "global/cloud_normals.hpp"

namespace scanlock {
namespace {

/// The lowest point of each horizontal cell with points, sorted by cell.
class LowestPoints {
 public:
  LowestPoints(const PointCloud& cloud, float cell) : cell_(cell) {
    lowest_.reserve(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i)
      lowest_.push_back({key(index(cloud.x[i]), index(cloud.y[i])), cloud.z[i]});
    std::sort(lowest_.begin(), lowest_.end(),
              [](const Lowest& a, const Lowest& b) { return a.key != b.key ? a.key < b.key : a.z < b.z; });
    lowest_.erase(std::unique(lowest_.begin(), lowest_.end(),
                              [](const Lowest& a, const Lowest& b) { return a.key == b.key; }),
                  lowest_.end());
  }

  /// about() the centres of the `count` cells nearest to the origin.
  std::vector<float> about_origin(std::size_t count) const {
    std::vector<Lowest> near = lowest_;
    const auto squared = [&](const Lowest& l) {
      const auto x = static_cast<double>(l.key & 0xffffffffu) - kMiddle;
      const auto y = static_cast<double>(l.key >> 32) - kMiddle;
      return x * x + y * y;
    };
    std::stable_sort(near.begin(), near.end(),
                     [&](const Lowest& a, const Lowest& b) { return squared(a) < squared(b); });
    near.resize(std::min(near.size(), count));
    std::vector<float> result;
    for (const Lowest& l : near) {
      const auto middle = [&](std::uint64_t index) {
        return (static_cast<float>(static_cast<std::int64_t>(index) - kMiddle) + 0.5f) * cell_;
      };
      result.push_back(about(middle(l.key & 0xffffffffu), middle(l.key >> 32)));
    }
    return result;
  }

  /// The lowest z, metres, in the nine cells around (x, y).
  float about(float x, float y) const {
    float z = std::numeric_limits<float>::infinity();
    for (std::int64_t dy = -1; dy <= 1; ++dy) {
      const std::uint64_t first = key(index(x) - 1, index(y) + dy);
      auto at = std::lower_bound(lowest_.begin(), lowest_.end(), first,
                                 [](const Lowest& a, std::uint64_t b) { return a.key < b; });
      for (; at != lowest_.end() && at->key <= first + 2; ++at) z = std::min(z, at->z);
    }
    return z;
  }

 private:
  struct Lowest {
    std::uint64_t key;
    float z;
  };
  static constexpr std::int64_t kMiddle = std::int64_t{1} << 30;
  std::int64_t index(float v) const { return static_cast<std::int64_t>(std::floor(v / cell_)); }
  static std::uint64_t key(std::int64_t x, std::int64_t y) {
    return static_cast<std::uint64_t>(y + kMiddle) << 32 | static_cast<std::uint64_t>(x + kMiddle);
  }

  float cell_;
  std::vector<Lowest> lowest_;
};

}  // namespace

std::vector<float> heights_above_ground(const PointCloud& cloud, float cell) {
  const LowestPoints lowest(cloud, cell);
  std::vector<float> heights(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    heights[i] = cloud.z[i] - lowest.about(cloud.x[i], cloud.y[i]);
  return heights;
}

std::optional<float> height_above_ground(const PointCloud& cloud, float cell) {
  constexpr std::size_t kCells = 16;
  std::vector<std::uint32_t> level;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (cloud.nz[i] >= kLevel && cloud.z[i] < 0) level.push_back(i);
  }
  std::vector<float> ground = LowestPoints(select(cloud, level), cell).about_origin(kCells);
  if (ground.empty()) return std::nullopt;
  const auto middle = ground.begin() + static_cast<std::ptrdiff_t>(ground.size() / 2);
  std::nth_element(ground.begin(), middle, ground.end());
  return -*middle;
}

}  // namespace scanlock
