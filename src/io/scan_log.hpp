// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/point_cloud.hpp"
#include "io/scan_directory.hpp"

namespace scanlock {

/// The messages that a scan can travel in: `pointcloud2`, `pointcloud`, `drake`, `sectors`, `planar`.
enum class ScanMessage { kPointcloud2, kPointcloud, kDrake, kSectors, kPlanar };

/// One message, or several for kSectors. `number` becomes the sequence number where the type has one.
std::vector<std::vector<std::uint8_t>> encode_scan(const Scan& scan, ScanMessage type, std::int32_t number);

/// Told how much is done, of how much.
using Progress = std::function<void(std::uint64_t done, std::uint64_t total)>;

struct ScanConversion {
  std::size_t scans = 0, points = 0;
  std::size_t left_out_points = 0;  ///< on the way out of a log: not finite, or exactly 0 0 0
  std::size_t rejected = 0;         ///< messages on the channel that hold no scan
  std::string first_error;          ///< of the first of those
  std::size_t incomplete = 0;       ///< scans of which sectors are missing
  std::string damage;               ///< a sentence on the state of the log, or empty
};

/// Writes the scans into a log. Each event carries the utime of its scan, so that lcm-logplayer plays at the
/// real rate.
ScanConversion directory_to_log(const ScanDirectory& directory, const std::string& log_path,
                                const std::string& channel, ScanMessage type, const Progress& progress);

/// Writes the scans of a channel, of any type that scanlock accepts, into a new directory; a damaged log
/// gives what can be read. Throws std::runtime_error naming file and channel when there is no scan; the
/// directory is made only then when there is one. `overwrite` and `extension`: see ScanDirectoryWriter.
ScanConversion log_to_directory(const std::string& log_path, const std::string& channel,
                                const std::string& directory_path, const Progress& progress,
                                bool overwrite = false, const std::string& extension = ".bin");

/// Writes one scan of a channel into a cloud file, of any extension that write_cloud knows: that of `number`,
/// counted from 0; where none is named, the only one. Throws std::runtime_error as above, and, naming what to
/// do, when there is more than one to choose from, or none of that number.
ScanConversion log_to_cloud(const std::string& log_path, const std::string& channel,
                            const std::string& cloud_path, std::optional<std::size_t> number,
                            const Progress& progress);

}  // namespace scanlock
