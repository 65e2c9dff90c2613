// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/scan_preparation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "geometry/elementary.hpp"
#include "geometry/voxel_grid.hpp"
#include "odometry/standing_alone.hpp"

namespace scanlock {
namespace {

/// The source is thinned to this many map voxels: to the most that still leave enough points. Wide ones are
/// better where points are many: the far and sparse points, which fix the rotation, then weigh as much as the
/// near and dense ones.
constexpr float kSourceVoxels[] = {2.0f, 1.41f, 1.0f};

constexpr double kVoxelPerRange = 0.045;     // the first guess, before a count is known
constexpr double kStep = 1.189207115002721;  // 2^(1/4)
constexpr double kPointsPerVoxel = 3.0, kPlanarPointsPerVoxel = 1.2;
constexpr double kBand = 1.3;
constexpr std::size_t kRays = 8192;  // about so many
constexpr int kSettlingRounds = 16;

PointCloud every_so_many(const PointCloud& points, const std::vector<std::uint32_t>& indices) {
  const std::size_t step = std::max<std::size_t>(indices.size() / kRays, 1);
  std::vector<std::uint32_t> some;
  some.reserve(indices.size() / step + 1);
  for (std::size_t k = 0; k < indices.size(); k += step) some.push_back(indices[k]);
  return select(points, some);
}

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

bool is_planar(const PointCloud& points) {
  constexpr float kFlat = 1e-3f;  // of the range
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(points.z[i]) > kFlat * points.point(i).norm()) return false;  // not for NaN
  }
  return true;
}

CroppedScan crop(const PointCloud& points, double min_range, double max_range) {
  CroppedScan result;
  const float least = static_cast<float>(min_range * min_range),
              greatest = static_cast<float>(max_range * max_range);
  RangeHistogram histogram;
  result.indices.resize(points.size());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float squared = points.x[i] * points.x[i] + points.y[i] * points.y[i] + points.z[i] * points.z[i];
    if (!(squared >= least && squared <= greatest)) continue;  // NaN fails too
    result.indices[kept++] = static_cast<std::uint32_t>(i);
    histogram.add(squared);
  }
  result.indices.resize(kept);
  result.median_range = histogram.median();
  return result;
}

std::string why_too_few(const PointCloud& points, const CroppedScan& cropped, double min_range,
                        double max_range) {
  std::vector<float> ranges;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float range = points.point(i).norm();
    if (std::isfinite(range)) ranges.push_back(range);
  }
  if (ranges.empty()) return "it has no point";
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  constexpr double kMostLidars = 400;  // metres: beyond the reach of nearly all of them
  char text[256];
  std::snprintf(
      text, sizeof text,
      "%zu of its %zu points are from %g to %g m away (tracker.%smin_range_m, max_range_m), too few to "
      "align; the median range of all points is %.3g m%s",
      cropped.indices.size(), points.size(), min_range, max_range, is_planar(points) ? "planar_" : "",
      static_cast<double>(*middle), *middle > kMostLidars ? ": are they millimetres?" : "");
  return text;
}

VoxelScale::VoxelScale(int wanted, double min_voxel, double max_voxel)
    : wanted_(wanted), min_voxel_(min_voxel), max_voxel_(max_voxel) {}

double VoxelScale::current(double median_range) {
  if (voxel_ == 0 && median_range > 0) {
    voxel_ =
        std::clamp(exp2(std::round(4.0 * log2(kVoxelPerRange * median_range)) / 4.0), min_voxel_, max_voxel_);
  }
  return voxel_ > 0 ? voxel_ : max_voxel_;
}

bool VoxelScale::adapt(std::size_t thinned, std::size_t cropped, bool planar) {
  if (voxel_ == 0 || cropped < kLeastPoints) return false;
  // Voxels of less than a few points of a scan do not thin it, and surfaces are then made of noise. A line
  // needs fewer points.
  const double share = planar ? kPlanarPointsPerVoxel : kPointsPerVoxel;
  const double wanted = std::min(wanted_, static_cast<double>(cropped) / share);
  const double count = static_cast<double>(thinned), before = voxel_;
  // On surfaces counts are proportional to 1/v^2, so that a step changes them by 1.41; the band of counts
  // without a step is wider.
  if (count > kBand * wanted) voxel_ *= kStep;
  if (count * kBand < wanted) voxel_ /= kStep;
  voxel_ = std::clamp(voxel_, min_voxel_, max_voxel_);
  return voxel_ != before;
}

PreparedScan thin_scan(const PointCloud& points, const CroppedScan& cropped, VoxelScale* scale, bool first,
                       int max_source_points) {
  PreparedScan result;
  result.median_range = cropped.median_range;
  result.planar = is_planar(points);
  std::vector<std::uint32_t> fine;
  // The first scan settles the size; later ones change it by one step at a time, for the scan after them.
  for (int round = 0; round < (first ? kSettlingRounds : 1); ++round) {
    result.voxel = scale->current(cropped.median_range);
    fine = thin_by_voxel(points, cropped.indices, static_cast<float>(result.voxel));
    if (!scale->adapt(fine.size(), cropped.indices.size(), result.planar)) break;
  }
  result.fine = select(points, fine);
  result.fine.alone =
      standing_alone(points, cropped.indices, result.fine, 2.0f * static_cast<float>(result.voxel));
  result.rays = every_so_many(points, cropped.indices);
  const std::size_t most = static_cast<std::size_t>(std::max(max_source_points, 1));
  std::vector<std::uint32_t> source;
  for (float voxels : kSourceVoxels) {
    source = thin_by_voxel(result.fine, voxels * static_cast<float>(result.voxel));
    if (2 * source.size() >= most) break;
  }
  if (source.size() > most) {  // evenly along the Morton curve, so evenly in space
    std::vector<std::uint32_t> fewer(most);
    for (std::size_t i = 0; i < most; ++i) fewer[i] = source[i * source.size() / most];
    source.swap(fewer);
  }
  result.source = select(result.fine, source);
  result.whole = result.source.size();
  return result;
}

}  // namespace scanlock
