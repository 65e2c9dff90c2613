// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/cloud_description.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "geometry/voxel_grid.hpp"
#include "global/cloud_normals.hpp"
#include "global/cpu_clock.hpp"
#include "global/descriptor_matching.hpp"
#include "global/ground_height.hpp"
#include "global/iss_keypoints.hpp"
#include "global/neighbour_lists.hpp"

namespace scanlock {
namespace {

constexpr double kWantedPoints = 8000, kWantedShare = 0.4, kTolerance = 1.25;
constexpr int kVoxelRounds = 8;
constexpr std::uint32_t kFewestNeighbours = 10;
// Columns next to the histograms, each of which adds up to 100: units per voxel of height, the largest height
// in voxels, and units for a vertical component of 1.
constexpr float kHeightWeight = 12, kMostHeight = 40, kTiltWeight = 20;

/// `count` of the indices, evenly spaced.
std::vector<std::uint32_t> spread(const std::vector<std::uint32_t>& from, std::size_t count) {
  if (from.size() <= count) return from;
  std::vector<std::uint32_t> result(count);
  for (std::size_t k = 0; k < count; ++k) result[k] = from[k * from.size() / count];
  return result;
}

/// `radius`: metres, of the neighbourhood that describes a point.
std::vector<std::uint32_t> spread_keypoints(const PointCloud& cloud, float radius, std::size_t count) {
  NeighbourFinder finder(cloud, radius);
  std::vector<std::uint8_t> enough(cloud.size(), 0);
  for (std::uint32_t i : finder.order()) enough[i] = finder.has_more_than(kFewestNeighbours, i);
  std::vector<std::uint32_t> steep, level;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (!enough[i] || cloud.normal(i).squaredNorm() < 0.5f) continue;
    (std::abs(cloud.nz[i]) < kLevel ? steep : level).push_back(i);
  }
  std::vector<std::uint32_t> keypoints = spread(steep, count);
  // Where there are hardly any steep surfaces, the shape of the ground has to describe the place.
  if (keypoints.size() < count / 2) {
    const auto more = spread(level, count / 2 - keypoints.size());
    keypoints.insert(keypoints.end(), more.begin(), more.end());
    std::sort(keypoints.begin(), keypoints.end());
  }
  return keypoints;
}

Descriptors with_level_columns(const CloudDescription& description, const Descriptors& histograms) {
  const PointCloud& cloud = description.points;
  const float voxel = static_cast<float>(description.voxel);
  const std::vector<float> heights = heights_above_ground(cloud, kGroundCell * voxel);
  Descriptors result(histograms.rows(), histograms.cols() + 2);
  result.leftCols(histograms.cols()) = histograms;
  for (Eigen::Index row = 0; row < histograms.rows(); ++row) {
    const std::uint32_t i = description.keypoints[static_cast<std::size_t>(row)];
    result(row, histograms.cols()) = kHeightWeight * std::min(heights[i] / voxel, kMostHeight);
    result(row, histograms.cols() + 1) = kTiltWeight * cloud.nz[i];
  }
  return result;
}

void check(const DescriptionOptions& o) {
  for (double value : {o.normal_radius, o.feature_radius, o.salient_radius, o.suppression_radius}) {
    if (!(value > 0 && value < 1000)) throw std::invalid_argument("describe: radii must be above 0");
  }
  if (!(o.voxel >= 0) || !std::isfinite(o.voxel))
    throw std::invalid_argument("describe: the voxel must be 0 (chosen) or above");
}

}  // namespace

DescriptionOptions paper_description() {
  DescriptionOptions options;
  options.choice = KeypointChoice::kIss;
  options.feature_radius = 5;
  options.levelled = false;
  return options;
}

double description_voxel(const PointCloud& cloud) {
  std::vector<std::uint32_t> finite;
  double reach = 0;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.point(i).allFinite()) continue;
    finite.push_back(i);
    reach = std::max(reach, static_cast<double>(cloud.point(i).cwiseAbs().maxCoeff()));
  }
  const double wanted = std::min(kWantedPoints, kWantedShare * static_cast<double>(finite.size()));
  if (!(reach > 0) || wanted < 1) return 0;
  // The number of points left on surfaces falls with the square of the voxel. The points left by a finer
  // voxel replace the cloud in later rounds, so that all points are visited only once or twice.
  double voxel = reach / 100, finer = 0;
  std::vector<std::uint32_t> some = finite;
  for (int round = 0; round < kVoxelRounds; ++round) {
    const bool from_some = finer > 0 && finer < 0.75 * voxel;
    std::vector<std::uint32_t> thin =
        thin_by_voxel(cloud, from_some ? some : finite, static_cast<float>(voxel));
    const double left = static_cast<double>(thin.size());
    if (left < wanted * kTolerance && left > wanted / kTolerance) break;
    if (left > wanted) {
      some = std::move(thin);
      finer = voxel;
    }
    voxel *= std::sqrt(std::max(left, 1.0) / wanted);
  }
  return voxel;
}

CloudDescription describe(const PointCloud& cloud, const DescriptionOptions& options) {
  check(options);
  CpuClock clock;
  CloudDescription result;
  result.options = options;
  result.voxel = options.voxel > 0 ? options.voxel : description_voxel(cloud);
  if (!(result.voxel > 0)) return result;
  result.points = select(cloud, thin_by_voxel(cloud, static_cast<float>(result.voxel)));
  const float voxel = static_cast<float>(result.voxel);
  add_normals(&result.points, static_cast<float>(options.normal_radius) * voxel);
  result.points_ms = clock.lap();
  if (options.choice == KeypointChoice::kIss) {
    IssOptions iss;
    iss.salient_radius = static_cast<float>(options.salient_radius) * voxel;
    iss.suppression_radius = static_cast<float>(options.suppression_radius) * voxel;
    const NeighbourLists near = radius_neighbours(result.points, iss.salient_radius);
    result.keypoints = iss_keypoints(result.points, near, iss);
  } else {
    const float widest = static_cast<float>(std::max(options.normal_radius, options.feature_radius));
    result.keypoints = spread_keypoints(result.points, widest * voxel, options.keypoints);
  }
  result.keypoints_ms = clock.lap();
  result.descriptors =
      fpfh(result.points, static_cast<float>(options.feature_radius) * voxel, result.keypoints);
  if (options.levelled) result.descriptors = with_level_columns(result, result.descriptors);
  result.features_ms = clock.lap();
  return result;
}

Matches match(const CloudDescription& source, const CloudDescription& target, int lambda) {
  Matches matches;
  const auto point = [](const CloudDescription& d, std::uint32_t row) {
    return Eigen::Vector3d(d.points.point(d.keypoints[row]).cast<double>());
  };
  if (source.keypoints.empty() || target.keypoints.empty()) return matches;
  for (const MutualPair& pair : mutual_nearest(source.descriptors, target.descriptors, lambda))
    matches.push_back({point(source, pair.a), point(target, pair.b)});
  return matches;
}

std::vector<SurfaceMatch> match_surfaces(const CloudDescription& source, const CloudDescription& target,
                                         int lambda) {
  std::vector<SurfaceMatch> matches;
  if (source.keypoints.empty() || target.keypoints.empty()) return matches;
  for (const MutualPair& pair : mutual_nearest(source.descriptors, target.descriptors, lambda)) {
    const std::uint32_t i = source.keypoints[pair.a], j = target.keypoints[pair.b];
    matches.push_back({source.points.point(i).cast<double>(), target.points.point(j).cast<double>(),
                       source.points.normal(i).cast<double>(), target.points.normal(j).cast<double>(),
                       pair.rank});
  }
  return matches;
}

CloudDescription part(const CloudDescription& whole, std::size_t stride) {
  CloudDescription result;
  result.points = whole.points;
  result.voxel = whole.voxel;
  const std::size_t count = (whole.keypoints.size() + stride - 1) / stride;
  result.descriptors.resize(static_cast<Eigen::Index>(count), whole.descriptors.cols());
  for (std::size_t k = 0; k < count; ++k) {
    result.keypoints.push_back(whole.keypoints[k * stride]);
    result.descriptors.row(static_cast<Eigen::Index>(k)) =
        whole.descriptors.row(static_cast<Eigen::Index>(k * stride));
  }
  return result;
}

CloudDescription redescribed(const CloudDescription& old, double feature_radius, std::size_t keypoints) {
  DescriptionOptions options = old.options;
  options.voxel = old.voxel;
  options.feature_radius = feature_radius;
  options.keypoints = keypoints;
  return describe(old.points, options);
}

}  // namespace scanlock
