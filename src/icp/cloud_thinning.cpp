// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/cloud_thinning.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/voxel_grid.hpp"

namespace scanlock {
namespace {

constexpr std::size_t kFew = 20000;      // points: a cloud up to this size needs no thinning
constexpr double kVoxelOfRadius = 0.05;  // first guess of the voxel: detail that is small against the scene
// This share of the points of a scan has all of its information: further points repeat their neighbours in
// the same row.
constexpr double kShare = 0.18, kLeast = 5000, kMostOfLeast = 24000, kMost = 30000;
constexpr double kAim = 1.05;  // of the wanted number of points, so that one more step is mostly enough
constexpr double kStep = 2.0;  // largest factor of the voxel in a step
constexpr double kLeastStep = 1.03;
constexpr int kRounds = 20;

/// Median distance of the points from their coordinate-wise median, metres, over every 16th point.
double median_radius(const PointCloud& cloud) {
  std::vector<float> axis[3], radii;
  for (std::size_t i = 0; i < cloud.size(); i += 16) {
    if (!cloud.point(i).allFinite()) continue;
    for (int k = 0; k < 3; ++k) axis[k].push_back(cloud.point(i)[k]);
  }
  if (axis[0].empty()) return 0;
  const auto median = [](std::vector<float> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  const Eigen::Vector3f centre(median(axis[0]), median(axis[1]), median(axis[2]));
  for (std::size_t i = 0; i < axis[0].size(); ++i)
    radii.push_back((Eigen::Vector3f(axis[0][i], axis[1][i], axis[2][i]) - centre).norm());
  return static_cast<double>(median(radii));
}

}  // namespace

double sensible_voxel(const PointCloud& cloud) {
  if (cloud.size() <= kFew) return 0;
  double voxel = kVoxelOfRadius * median_radius(cloud);
  if (!(voxel > 0)) return 0;
  const double least = std::clamp(kShare * static_cast<double>(cloud.size()), kLeast, kMostOfLeast);
  for (int round = 0; round < kRounds; ++round) {
    const double left = static_cast<double>(count_voxels(cloud, static_cast<float>(voxel)));
    if (left >= least && left <= kMost) break;
    // The number of voxels grows with 1 / voxel on scan rows that are far apart, and faster on densely
    // sampled surfaces.
    if (left < least) {
      voxel /= std::clamp(kAim * least / std::max(left, 1.0), kLeastStep, kStep);
    } else {
      voxel *= std::clamp(std::sqrt(kAim * left / kMost), kLeastStep, kStep);
    }
  }
  return voxel;
}

PointCloud thinned_by(const PointCloud& cloud, double voxel) {
  return voxel > 0 ? average_by_voxel(cloud, static_cast<float>(voxel)) : cloud;
}

}  // namespace scanlock
