// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/point_cloud.hpp"

namespace scanlock {

/// A directory of numbered scans: files whose name ends in digits before .bin, .pcd or .ply (000000.bin,
/// scan_17.pcd), in the order of those numbers. Beside them, both optional:
///   times.txt          a line for each scan, in their order: seconds, the instant the scan is stamped with
///   ptime/NAME.f32     for the scan NAME.*: float32 (little endian) for each point, seconds relative to that
///   instant
class ScanDirectory {
 public:
  /// What stands in for times.txt where there is none.
  struct Clock {
    double period_s = 0.1;
    /// Microseconds: the utime of time zero, that is of the first scan where there is no times.txt. Below
    /// zero, the default: times.txt is taken as it stands when it begins after zero; else zero is utime
    /// 1000000, because a utime of 0 means "no time" to many.
    std::int64_t zero_utime = -1;
    /// The utime of the first scan, or pose, that has no time of its own.
    std::int64_t first_utime() const { return zero_utime >= 0 ? zero_utime : 1000000; }
  };

  /// Lists the directory and reads times.txt. Throws std::runtime_error naming the path, and the line of
  /// times.txt.
  ScanDirectory(const std::string& path, const Clock& clock);

  std::size_t size() const { return scans_.size(); }
  std::int64_t utime(std::size_t index) const { return utimes_[index]; }
  /// Reads one scan with the times of its points. Throws std::runtime_error as read_cloud does, and when the
  /// ptime file does not fit the scan.
  Scan read(std::size_t index) const;

 private:
  void list_scans();
  void stamp(const Clock& clock);

  std::string path_;
  std::vector<std::string> scans_;  ///< file names
  std::vector<std::int64_t> utimes_;
};

/// Writes a directory that ScanDirectory reads back: NNNNNN.bin (or .pcd, .ply), times.txt, and, where points
/// have times and a .bin has no column for them, ptime/.
class ScanDirectoryWriter {
 public:
  /// Makes the directory. With `overwrite` what an earlier writer of the same extension left in it is
  /// removed. Throws std::runtime_error naming it when it cannot be made, when it is there and not empty, or,
  /// with `overwrite`, when it holds scans of other names, which would mix with ours.
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

/// Whether a ScanDirectoryWriter may write an entry of this name into its directory.
bool is_scan_directory_name(const std::string& name);

}  // namespace scanlock
