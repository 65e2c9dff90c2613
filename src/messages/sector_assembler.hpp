// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "messages/decode_scan.hpp"

namespace scanlock {

/// Puts scanlock.scan_sector_t slices together again; one assembler a channel. Everything that is not a
/// sector, faults included, passes through at once, so that a receiver may write `for (DecodedScan& scan :
/// assembler.add(decode_scan(data, size))) ...` whatever the type.
///
/// A scan comes out the moment its last sector is there, or incomplete (`sectors_missing` > 0) when the next
/// scan begins. Points come in the order of the sectors, not of their arrival. Pure: no clock, no thread; it
/// holds the slices of one scan, never more than `max_points` points.
class SectorAssembler {
 public:
  explicit SectorAssembler(std::size_t max_points = DecodeLimits{}.max_points) : max_points_(max_points) {}

  /// The scans that are finished by this one: none, one, or two (an incomplete one and a whole one behind
  /// it).
  std::vector<DecodedScan> add(DecodedScan decoded);

  /// The incomplete scan that is still waiting, for the end of a log.
  std::optional<DecodedScan> flush();

  /// Sectors that were thrown away: twice the same, of a scan that had gone out already, or contradicting
  /// their scan.
  std::int64_t discarded_sectors() const { return discarded_sectors_; }

 private:
  struct Slices {
    DecodedScan head;                  ///< of the first sector that came, without its points
    std::map<int, PointCloud> points;  ///< by sector index
    std::size_t point_count = 0;
  };
  bool is_late(const DecodedScan& sector) const;
  bool insert(DecodedScan& sector);

  std::size_t max_points_;
  std::optional<Slices> waiting_;
  bool any_ = false;               ///< at least one scan has begun
  std::int64_t newest_utime_ = 0;  ///< stamp and count of the scan that began last
  std::int32_t newest_seq_ = 0;
  std::int64_t discarded_sectors_ = 0;
};

}  // namespace scanlock
