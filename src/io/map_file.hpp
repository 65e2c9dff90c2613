// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "odometry/keyframe_archive.hpp"

namespace scanlock {

/// A map file, version 4. All numbers little-endian; a pose is the upper three rows of its matrix, row-major,
/// as 12 float64.
///
///     offset  size  what
///     0       8     89 53 4C 4D 41 50 0D 0A (".SLMAP" and a line end that text conversions damage)
///     8       4     version
///     12      8     bytes of the body
///     20            body: uint32 epoch, pose last_pose, float64 up[3] (not in versions 1 to 3: the z axis),
///                   uint32 keyframes, then of each keyframe
///                     int64 utime, pose map_from_body, float32 reach, int32 k, uint32 points n,
///                     int16 x[n], y[n], z[n] in steps of 2^k metres,
///                     uint32 stands m, float32 x, y, z of each (not in version 1);
///                   then (not in versions 1 and 2) uint32 constraints, of each
///                     uint32 from, to (keyframes, counted from 1; 0 is the map's frame), pose from_to,
///                     uint32 1 for a loop closure, else 0, float64 information[21] (upper triangle,
///                     row-major)
///     end - 4 4     CRC-32 of everything before
///
/// The step is the smallest power of two that reaches the keyframe's farthest coordinate in 32767 steps, so a
/// coordinate is kept to half of it: 2 mm where the farthest is 100 m, 0.25 mm where it is 15 m. Poses are
/// kept exactly, and a map of this version that was read is written to the same bytes again. Versions 1 to 3
/// are read, too.
constexpr std::uint32_t kMapVersion = 4;

/// Points that are not finite are left out.
std::vector<std::uint8_t> encode_map(const SavedMap& map);

/// Throws std::runtime_error "NAME: byte N: what is wrong" for content that is no map, of a newer version,
/// damaged or cut. No size is believed before the bytes for it are there.
SavedMap decode_map(const std::vector<std::uint8_t>& bytes, const std::string& name);

/// Replaces the file in one step (see `write_file_atomically`). Throws std::runtime_error naming the path;
/// also when another file than a map is there, which is then left alone, and PointsUnreadable.
void write_map(const std::string& path, const SavedMap& map);

/// The points stay in the file, which is kept open: see KeyframePoints. A file that takes its name, as
/// write_map makes one, does not matter; where it is changed in place its points are unreadable. Throws
/// std::runtime_error as decode_map, and for a file that cannot be read or has over 4 GB.
SavedMap read_map(const std::string& path);

}  // namespace scanlock
