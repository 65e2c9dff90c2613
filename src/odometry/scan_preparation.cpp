// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/scan_preparation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "geometry/voxel_grid.hpp"

namespace scanlock {
namespace {

/// The source is thinned to this many map voxels.
constexpr float kSourceVoxels = 2.0f;

/// Squared ranges in bins of 1/16 octave (of the range: 1/32): the top bits of a float are a logarithm.
class RangeHistogram {
 public:
  void add(float squared_range) { ++counts_[bin(squared_range)]; }
  double median() const {
    std::size_t total = 0, below = 0;
    for (std::size_t count : counts_) total += count;
    for (std::size_t b = 0; b < counts_.size(); ++b) {
      below += counts_[b];
      if (2 * below > total) return std::sqrt(static_cast<double>(value(b)));
    }
    return 0;
  }

 private:
  static constexpr int kShift = 23 - 4;
  static std::size_t bin(float v) {
    std::uint32_t bits;
    std::memcpy(&bits, &v, sizeof bits);
    return bits >> kShift;
  }
  static float value(std::size_t bin) {
    const std::uint32_t bits = static_cast<std::uint32_t>(bin) << kShift;
    float v;
    std::memcpy(&v, &bits, sizeof v);
    return v;
  }
  std::array<std::uint32_t, 1u << (31 - kShift)> counts_{};
};

}  // namespace

CroppedScan crop(const PointCloud& points, double min_range, double max_range) {
  CroppedScan result;
  const float least = static_cast<float>(min_range * min_range), greatest = static_cast<float>(max_range * max_range);
  RangeHistogram histogram;
  result.indices.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float squared = points.x[i] * points.x[i] + points.y[i] * points.y[i] + points.z[i] * points.z[i];
    if (!(squared >= least && squared <= greatest)) continue;  // NaN fails too
    result.indices.push_back(static_cast<std::uint32_t>(i));
    histogram.add(squared);
  }
  result.median_range = histogram.median();
  return result;
}

VoxelScale::VoxelScale(double voxel_per_range, double min_voxel, double max_voxel)
    : voxel_per_range_(voxel_per_range), min_voxel_(min_voxel), max_voxel_(max_voxel) {}

double VoxelScale::update(double median_range) {
  if (!(median_range > 0)) return voxel_ > 0 ? voxel_ : max_voxel_;
  const double log_range = std::log2(median_range);
  smoothed_log_range_ = voxel_ > 0 ? smoothed_log_range_ + 0.1 * (log_range - smoothed_log_range_) : log_range;
  const double wanted = smoothed_log_range_ + std::log2(voxel_per_range_);
  // Half-octave steps; a step is left only when the wish is more than 0.4 octaves away.
  if (voxel_ == 0 || std::abs(wanted - std::log2(voxel_)) > 0.4) voxel_ = std::exp2(std::round(2.0 * wanted) / 2.0);
  return std::clamp(voxel_, min_voxel_, max_voxel_);
}

PreparedScan thin_scan(const PointCloud& points, const CroppedScan& cropped, double voxel, int max_source_points) {
  PreparedScan result;
  const float size = static_cast<float>(voxel);
  const std::vector<std::uint32_t> fine = thin_by_voxel(points, cropped.indices, size);
  result.fine = select(points, fine);
  std::vector<std::uint32_t> source = thin_by_voxel(result.fine, kSourceVoxels * size);
  const std::size_t most = static_cast<std::size_t>(std::max(max_source_points, 1));
  if (source.size() > most) {  // evenly along the Morton curve, so evenly in space
    std::vector<std::uint32_t> fewer(most);
    for (std::size_t i = 0; i < most; ++i) fewer[i] = source[i * source.size() / most];
    source.swap(fewer);
  }
  result.source = select(result.fine, source);
  return result;
}

}  // namespace scanlock
