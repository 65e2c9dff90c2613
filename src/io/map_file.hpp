// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "odometry/keyframe_archive.hpp"

namespace scanlock {

/// A map file, version 4. All numbers are little-endian; a pose is the upper three rows of its matrix,
/// row-major, as 12 float64.
///
///     offset  size  content
///     0       8     89 53 4C 4D 41 50 0D 0A (".SLMAP" and a line end that text conversions damage)
///     8       4     version
///     12      8     bytes of the body
///     20            body: uint32 epoch, pose last_pose, float64 up[3] (not in versions 1 to 3: the z axis),
///                   uint32 keyframes, then of each keyframe
///                     int64 utime, pose map_from_body, float32 reach, int32 k, uint32 points n,
///                     int16 x[n], y[n], z[n] in steps of 2^k metres,
///                     uint32 m body-up attitudes (stands), float32 x, y, z of each (not in version 1);
///                   then (not in versions 1 and 2) uint32 constraints, of each
///                     uint32 from, to (keyframes, counted from 1; 0 is the map's frame), pose from_to,
///                     uint32 1 for a loop closure, else 0, float64 information[21] (upper triangle,
///                     row-major)
///     end - 4 4     CRC-32 of all bytes before it
///
/// The step 2^k is the smallest power of two for which the keyframe's largest coordinate is at most 32767
/// steps. Coordinates are therefore rounded by at most half a step: 2 mm where the largest is 100 m, 0.25 mm
/// where it is 15 m. Poses are stored exactly, and reading and writing a map of this version reproduces the
/// same bytes. Versions 1 to 3 can also be read.
constexpr std::uint32_t kMapVersion = 4;

/// Encodes a map. Points that are not finite are left out.
std::vector<std::uint8_t> encode_map(const SavedMap& map);

/// Throws std::runtime_error "NAME: byte N: what is wrong" for content that is not a map, has a newer
/// version, is damaged or is cut. A size is accepted only when the bytes for it are present.
SavedMap decode_map(const std::vector<std::uint8_t>& bytes, const std::string& name);

/// Throws std::runtime_error when the file exists and is not a map: a wrong path on the command line must not
/// destroy it.
void check_map_path(const std::string& path);

/// Replaces the file atomically (see write_file_atomically()). Throws std::runtime_error naming the path,
/// also as check_map_path() does, and PointsUnreadable; the file is left unchanged then.
void write_map(const std::string& path, const SavedMap& map);

/// Reads a map. The points stay in the file, which is kept open: see KeyframePoints. Replacing the file by
/// another one of the same name, as write_map() does, is harmless; modifying it in place makes its points
/// unreadable. Throws std::runtime_error as decode_map() does, and for a file that cannot be read or is
/// larger than 4 GB.
SavedMap read_map(const std::string& path);

}  // namespace scanlock
