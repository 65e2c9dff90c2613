// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// A directory of numbered scans: files whose name ends in digits before .bin, .pcd or .ply (000000.bin,
/// scan_17.pcd), in the order of those numbers. Two optional files beside them:
///   times.txt          one line per scan, in the same order: the stamp of the scan in seconds
///   ptime/NAME.f32     for the scan NAME.*: one float32 (little endian) per point, seconds relative to the
///                      stamp
class ScanDirectory {
 public:
  /// The stamps of the scans when there is no times.txt.
  struct Clock {
    double period_s = 0.1;
    /// Microseconds: the utime of time zero, which is the first scan when there is no times.txt. With the
    /// default (negative), times.txt is used as it is if its first time is above zero; otherwise time zero is
    /// utime 1000000, because many programs take a utime of 0 for "no time".
    std::int64_t zero_utime = -1;
    /// The utime of a first scan, or first pose, that has no time of its own.
    std::int64_t first_utime() const { return zero_utime >= 0 ? zero_utime : 1000000; }
  };

  /// Lists the directory and reads times.txt. Throws std::runtime_error naming the path, and the line if
  /// times.txt is at fault.
  ScanDirectory(const std::string& path, const Clock& clock);

  std::size_t size() const { return scans_.size(); }
  std::int64_t utime(std::size_t index) const { return utimes_[index]; }
  /// Reads one scan with the times of its points. Throws std::runtime_error as read_cloud() does, and when
  /// the number of times in the ptime file differs from the number of points.
  Scan read(std::size_t index) const;

 private:
  void list_scans();
  void stamp(const Clock& clock);

  std::string path_;
  std::vector<std::string> scans_;  ///< file names
  std::vector<std::int64_t> utimes_;
};

/// Writes a directory that ScanDirectory can read: NNNNNN.bin (or .pcd, .ply), times.txt, and, for .bin,
/// which has no column for the times of points, ptime/.
class ScanDirectoryWriter {
 public:
  /// Makes the directory. With `overwrite`, the files that an earlier writer with the same extension left in
  /// it are removed. Throws std::runtime_error naming the directory when it cannot be made; without
  /// `overwrite`, when it is not empty; with `overwrite`, when it holds scans under other names, which would
  /// mix with the new ones.
  explicit ScanDirectoryWriter(const std::string& path, bool overwrite = false,
                               const std::string& extension = ".bin");
  void write(const Scan& scan);
  /// Writes times.txt; call it after the last scan.
  void close();
  std::size_t size() const { return count_; }

 private:
  std::string path_, extension_;
  std::string times_;
  std::size_t count_ = 0;
};

/// Whether a ScanDirectoryWriter may write a file or folder of this name into its directory.
bool is_scan_directory_name(const std::string& name);

}  // namespace scanlock
