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

/// Reads a cloud; the extension (in any case) names the format:
///   .bin         KITTI: float32 x y z intensity, little endian
///   .ply         ascii, binary little and big endian; the element `vertex`, all others are skipped
///   .pcd         ascii, binary, binary_compressed; VIEWPOINT is not applied
///   .xyz, .txt   a point a line: x y z [intensity]; `#` starts a comment
/// In .ply and .pcd columns may stand in any order and have any scalar type; taken are x, y, z, nx, ny, nz
/// (normal_x, normal_y, normal_z), intensity (scalar_intensity), and `time` when it is a float32: seconds
/// relative to the stamp of the scan. Coordinates become floats: a far origin (UTM) is to be subtracted
/// before, see `offset` below.
///
/// Every point is kept, NaN and infinite ones too, in the order of the file: the caller decides what they
/// mean. Throws std::runtime_error "FILE:LINE: what" (text) or "FILE: byte N: what" (binary) for a file that
/// is damaged or does not hold what its header promises; it never allocates more than the size of the file
/// justifies.
PointCloud read_cloud(const std::string& path);

/// Takes the points of a file, in clouds of kPartPoints and a last one of what is left.
using TakePoints = std::function<void(PointCloud&& part)>;
inline constexpr std::size_t kPartPoints = 1u << 18;

/// The same for a file that need not fit into memory: its points are handed on in the order of the file, and
/// no more than a part of them is held, but for .pcd with binary_compressed, which is held as a whole. What
/// was handed on before an error is of the file, too. `progress`: bytes read, and bytes in all. `offset`:
/// metres, subtracted from the coordinates before they become floats.
void read_cloud(const std::string& path, const TakePoints& take,
                const std::function<void(std::uint64_t, std::uint64_t)>& progress = {},
                const Eigen::Vector3d& offset = Eigen::Vector3d::Zero());

/// Writes all that the cloud has and the format can hold; .ply and .pcd are written binary, with `time` as
/// above. A .bin without intensities gets zeros. Throws std::runtime_error naming the path when the write
/// fails.
void write_cloud(const std::string& path, const PointCloud& cloud);

/// Throws std::runtime_error where the extension names no format, as the two above do.
void check_cloud_path(const std::string& path);

}  // namespace scanlock
