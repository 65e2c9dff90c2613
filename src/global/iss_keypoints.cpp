// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/iss_keypoints.hpp"

#include "geometry/symmetric_eigen.hpp"

namespace scanlock {
namespace {

/// The smallest eigenvalue of the scatter of the neighbours about the point; 0 if the point cannot be a
/// keypoint.
double saliency(const PointCloud& cloud, const NeighbourLists& neighbours, std::size_t i,
                const IssOptions& options) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  const Eigen::Vector3f centre = cloud.point(i);
  for (std::uint32_t e = neighbours.begin[i]; e < neighbours.begin[i + 1]; ++e) {
    const Eigen::Vector3d d = (cloud.point(neighbours.index[e]) - centre).cast<double>();
    scatter += d * d.transpose();
  }
  const Eigen::Vector3d l = symmetric_eigen(scatter).values;  // ascending
  const bool distinct = l[1] < static_cast<double>(options.ratio21) * l[2] &&
                        l[0] < static_cast<double>(options.ratio32) * l[1];
  return distinct && l[0] > 1e-9 * l[2] ? l[0] : 0.0;  // smaller values are rounding errors
}

}  // namespace

std::vector<std::uint32_t> iss_keypoints(const PointCloud& cloud, const NeighbourLists& neighbours,
                                         const IssOptions& options) {
  std::vector<double> salient(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) salient[i] = saliency(cloud, neighbours, i, options);
  const float reach = options.suppression_radius * options.suppression_radius;
  std::vector<std::uint32_t> keypoints;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (!(salient[i] > 0)) continue;
    int near = 0;
    bool largest = true;
    for (std::uint32_t e = neighbours.begin[i]; e < neighbours.begin[i + 1] && largest; ++e) {
      if (neighbours.squared_distance[e] > reach) continue;
      ++near;
      largest = salient[neighbours.index[e]] <= salient[i];
    }
    if (largest && near >= options.least_neighbours) keypoints.push_back(i);
  }
  return keypoints;
}

}  // namespace scanlock
