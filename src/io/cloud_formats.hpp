// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/point_cloud.hpp"

// The formats behind cloud_file.hpp, one file each; `path` is for the errors only.
namespace scanlock {

PointCloud parse_kitti_bin(const std::string& path, const std::vector<std::uint8_t>& bytes);
PointCloud parse_ply(const std::string& path, const std::vector<std::uint8_t>& bytes);
PointCloud parse_pcd(const std::string& path, const std::vector<std::uint8_t>& bytes);
PointCloud parse_xyz(const std::string& path, const std::vector<std::uint8_t>& bytes);

std::string format_kitti_bin(const PointCloud& cloud);
std::string format_ply(const PointCloud& cloud);
std::string format_pcd(const PointCloud& cloud);
std::string format_xyz(const PointCloud& cloud);

}  // namespace scanlock
