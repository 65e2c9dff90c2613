// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "global/neighbour_lists.hpp"

namespace scanlock {

struct IssOptions {
  float salient_radius = 0;  ///< metres: of the neighbourhood whose scatter is taken
  float suppression_radius =
      0;  ///< metres, at most the salient radius: a keypoint is the most salient point within it
  float ratio21 = 0.975f, ratio32 = 0.975f;  ///< largest ratios of successive eigenvalues
  int least_neighbours = 5;                  ///< within the suppression radius, the point itself included
};

/// Intrinsic shape signature keypoints (Zhong 2009), as ascending indices. As in the Point Cloud Library, the
/// scatter of a neighbourhood is about its point, unweighted. `neighbours`: those within the salient radius.
std::vector<std::uint32_t> iss_keypoints(const PointCloud& cloud, const NeighbourLists& neighbours,
                                         const IssOptions& options);

}  // namespace scanlock
