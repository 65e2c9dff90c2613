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

/// The message types that can carry a scan: `pointcloud2`, `pointcloud`, `drake`, `sectors`, `planar`.
enum class ScanMessage { kPointcloud2, kPointcloud, kDrake, kSectors, kPlanar };

/// One message; for kSectors possibly several. `number` becomes the sequence number if the type has one.
std::vector<std::vector<std::uint8_t>> encode_scan(const Scan& scan, ScanMessage type, std::int32_t number);

/// Called with the amount of work done and the total amount.
using Progress = std::function<void(std::uint64_t done, std::uint64_t total)>;

struct ScanConversion {
  std::size_t scans = 0, points = 0;
  std::size_t left_out_points = 0;  ///< not finite, or exactly 0 0 0; only when reading a log
  std::size_t rejected = 0;         ///< messages on the channel that hold no scan
  std::string first_error;          ///< the reason for the first rejected message
  std::size_t incomplete = 0;       ///< scans with missing sectors
  std::string damage;               ///< a sentence on the state of the log, or empty
};

/// Writes the scans into a log. Each event gets the utime of its scan, so that lcm-logplayer plays them at
/// their original rate.
ScanConversion directory_to_log(const ScanDirectory& directory, const std::string& log_path,
                                const std::string& channel, ScanMessage type, const Progress& progress);

/// Writes the scans of a channel, of any type that scanlock accepts, into a new directory; of a damaged log,
/// the readable scans. Throws std::runtime_error naming the file and the channel when there is no scan; the
/// directory is made only when there is at least one. `overwrite` and `extension`: see ScanDirectoryWriter.
ScanConversion log_to_directory(const std::string& log_path, const std::string& channel,
                                const std::string& directory_path, const Progress& progress,
                                bool overwrite = false, const std::string& extension = ".bin");

/// Writes one scan of a channel into a cloud file, of any extension that write_cloud() knows: scan `number`,
/// counted from 0, or, without `number`, the only scan. Throws std::runtime_error as above, and, with advice,
/// when `number` is missing and the channel holds several scans, or when no scan has that number.
ScanConversion log_to_cloud(const std::string& log_path, const std::string& channel,
                            const std::string& cloud_path, std::optional<std::size_t> number,
                            const Progress& progress);

}  // namespace scanlock
