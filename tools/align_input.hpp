// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Reads the input files of scanlock-align.
#pragma once

#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "geometry/rigid.hpp"
#include "io/cloud_file.hpp"
#include "io/file_bytes.hpp"

namespace scanlock {

/// Reads a cloud. Throws std::runtime_error where it has fewer than 3 finite points, which any alignment
/// needs.
inline PointCloud read_points(const std::string& path) {
  constexpr std::size_t kFewest = 3;
  PointCloud cloud = read_cloud(path);
  std::size_t finite = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) finite += cloud.point(i).allFinite() ? 1 : 0;
  if (finite >= kFewest) return cloud;
  throw std::runtime_error(path + ": " + std::to_string(finite) +
                           " finite points; an alignment takes at least " + std::to_string(kFewest));
}

/// Reads a rigid transform, four rows of four numbers. Throws std::runtime_error for any other file.
inline Pose read_transform(const std::string& path) {
  const std::vector<std::uint8_t> bytes = read_file_bytes(path);
  std::istringstream file(std::string(bytes.begin(), bytes.end()));
  Eigen::Matrix4d m;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      if (!(file >> m(row, column)) || !std::isfinite(m(row, column)))
        throw std::runtime_error(path + ": row " + std::to_string(row + 1) + ", number " +
                                 std::to_string(column + 1) +
                                 ": a transform is 16 numbers, four rows of four");
    }
  }
  const Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
  if ((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-3 || r.determinant() < 0 ||
      (m.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() > 1e-9)
    throw std::runtime_error(
        path + ": not a rigid transform (rows of R are not orthonormal, or the last row is not 0 0 0 1)");
  Pose pose = Pose::Identity();
  pose.linear() = r;
  pose.translation() = m.topRightCorner<3, 1>();
  return renormalised(pose);
}

}  // namespace scanlock
