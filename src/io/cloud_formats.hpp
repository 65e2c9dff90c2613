// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "geometry/point_cloud.hpp"
#include "io/byte_source.hpp"
#include "io/cloud_columns.hpp"

// The formats behind cloud_file.hpp, one source file each. `path` is used in error messages only. Points are
// passed on in parts of kPartPoints.
namespace scanlock {

void parse_kitti_bin(const std::string& path, ByteSource& source, const PointSink& sink);
void parse_ply(const std::string& path, ByteSource& source, const PointSink& sink);
void parse_pcd(const std::string& path, ByteSource& source, const PointSink& sink);
void parse_xyz(const std::string& path, ByteSource& source, const PointSink& sink);

std::string format_kitti_bin(const PointCloud& cloud);
std::string format_ply(const PointCloud& cloud);
std::string format_pcd(const PointCloud& cloud);
std::string format_xyz(const PointCloud& cloud);

}  // namespace scanlock
