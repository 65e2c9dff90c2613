// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// Reads a cloud; the extension (upper or lower case) selects the format:
///   .bin         KITTI: float32 x y z intensity, little endian
///   .ply         ascii, binary little and big endian; the element `vertex` is read, all others are skipped
///   .pcd         ascii, binary, binary_compressed; VIEWPOINT is not applied
///   .xyz, .txt   one point per line: x y z [intensity]; `#` starts a comment
/// In .ply and .pcd the columns may have any order and any scalar type. The columns read are x, y, z, nx, ny,
/// nz (normal_x, normal_y, normal_z), intensity (scalar_intensity), and `time` if it is a float32: seconds
/// relative to the stamp of the scan. Coordinates become floats; subtract a distant origin (UTM) with the
/// parameter `offset` of the overload below.
///
/// Every point is kept, in the order of the file, including NaN and infinite points; the caller decides how
/// to treat those. Throws std::runtime_error "FILE:LINE: what" (text) or "FILE: byte N: what" (binary) when
/// the file is damaged or holds less than its header states. Never allocates more memory than the size of the
/// file justifies.
PointCloud read_cloud(const std::string& path);

/// Receives the points of a file in clouds of kPartPoints points each; the last cloud may be smaller.
using TakePoints = std::function<void(PointCloud&& part)>;
inline constexpr std::size_t kPartPoints = 1u << 18;

/// Reads a file that need not fit into memory. Points are passed to `take` in the order of the file, and at
/// most kPartPoints of them are held at a time, except for binary_compressed .pcd, which is held as a whole.
/// Points that were passed on before an error are valid points of the file. `progress`: bytes read, and bytes
/// in total. `offset`: metres, subtracted from the coordinates before they become floats.
void read_cloud(const std::string& path, const TakePoints& take,
                const std::function<void(std::uint64_t, std::uint64_t)>& progress = {},
                const Eigen::Vector3d& offset = Eigen::Vector3d::Zero());

/// Writes every attribute that both the cloud has and the format can hold; .ply and .pcd are written as
/// binary, with `time` as above. A .bin of a cloud without intensities gets intensity 0. Throws
/// std::runtime_error naming the path when the write fails.
void write_cloud(const std::string& path, const PointCloud& cloud);

/// Throws std::runtime_error, as read_cloud() and write_cloud() do, when the extension is not one of a known
/// format.
void check_cloud_path(const std::string& path);

}  // namespace scanlock
