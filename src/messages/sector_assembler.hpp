// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "messages/decode_scan.hpp"

namespace scanlock {

/// Joins scanlock.scan_sector_t messages to scans; use one assembler per channel. All other scans, and
/// faults, pass through at once, so that a receiver can write `for (DecodedScan& scan :
/// assembler.add(decode_scan(data, size))) ...` for any type.
///
/// A scan is returned when its last sector arrives, or incomplete (`sectors_missing` > 0) when a sector of
/// another scan arrives first. Points are in the order of the sectors, not of their arrival. Uses no clock
/// and no thread; holds the sectors of one scan, at most `max_points` points.
class SectorAssembler {
 public:
  explicit SectorAssembler(std::size_t max_points = DecodeLimits{}.max_points) : max_points_(max_points) {}

  /// The scans that this message finishes: none, one, or two (an incomplete scan, then a complete one).
  std::vector<DecodedScan> add(DecodedScan decoded);

  /// The incomplete scan that is still waiting, to be called at the end of a log.
  std::optional<DecodedScan> flush();

  /// Sectors that were discarded: repeated, of a scan that was returned already, over `max_points`, or with
  /// another sector_count than the scan's first sector.
  std::int64_t discarded_sectors() const { return discarded_sectors_; }
  /// The reason for the last discarded sector, in words.
  const std::string& last_discarded() const { return last_discarded_; }

 private:
  using Key = std::pair<std::int64_t, std::int32_t>;  ///< utime and sequence number of a scan
  struct Slices {
    DecodedScan head;                  ///< the first sector that arrived, without its points
    std::map<int, PointCloud> points;  ///< by sector index
    std::size_t point_count = 0;
  };
  void begin(const Key& key);
  bool insert(DecodedScan& sector);
  bool discard(const char* why);

  std::size_t max_points_;
  std::optional<Slices> waiting_;
  std::deque<Key> begun_;  ///< the last 16 scans that have begun, the newest last
  std::int64_t discarded_sectors_ = 0;
  std::string last_discarded_;
};

}  // namespace scanlock
