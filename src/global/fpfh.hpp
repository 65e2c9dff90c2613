// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// One descriptor per row.
using Descriptors = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline constexpr int kFpfhSize = 33;  ///< three histograms of eleven bins

/// Fast point feature histograms (Rusu, Blodow and Beetz 2009) of the points at `keypoints`, kFpfhSize
/// columns, from the points within `radius` metres of each point; each of the three histograms adds up to
/// 100. Up to rounding the definition of the Point Cloud Library. The cloud must have unit normals, else
/// throws std::invalid_argument; a keypoint without neighbours gets zeros.
Descriptors fpfh(const PointCloud& cloud, float radius, const std::vector<std::uint32_t>& keypoints);

}  // namespace scanlock
