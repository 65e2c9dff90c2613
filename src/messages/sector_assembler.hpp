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
  /// Why the last of those was, in words.
  const std::string& last_discarded() const { return last_discarded_; }

 private:
  using Key = std::pair<std::int64_t, std::int32_t>;  ///< stamp and count of a scan
  struct Slices {
    DecodedScan head;                  ///< of the first sector that came, without its points
    std::map<int, PointCloud> points;  ///< by sector index
    std::size_t point_count = 0;
  };
  void begin(const Key& key);
  bool insert(DecodedScan& sector);
  bool discard(const char* why);

  std::size_t max_points_;
  std::optional<Slices> waiting_;
  std::deque<Key> begun_;  ///< the last few scans that have begun, the newest last
  std::int64_t discarded_sectors_ = 0;
  std::string last_discarded_;
};

}  // namespace scanlock
