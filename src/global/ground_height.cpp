// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/ground_height.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace scanlock {
namespace {

/// The lowest point of each cell that has one, sorted by cell.
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
  std::int64_t index(float v) const { return static_cast<std::int64_t>(std::floor(v / cell_)); }
  static std::uint64_t key(std::int64_t x, std::int64_t y) {
    constexpr std::int64_t kMiddle = std::int64_t{1} << 30;
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

}  // namespace scanlock
