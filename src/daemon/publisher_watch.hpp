// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "odometry/tracked_scan.hpp"

namespace scanlock {

// Two publishers on one channel are as common a mistake as a log that is replayed beside a live driver. They
// show in their counts of scans, in stamps of two clocks, or in that every other scan is of another place.

/// By the counts, which senders number their scans with.
class CountWatch {
 public:
  /// The count of one more message, 0 where its type has none; of a sector, that of its scan. True when for
  /// ten messages in a row the counts have been those of two senders in turn.
  bool interleaves(std::int32_t count, bool sector);
  /// The last two, for a sentence.
  std::string counts() const;

 private:
  std::array<std::int32_t, 2> last_{};  ///< the newer one last
  int interleaved_ = 0;
};

/// By what became of the scans.
class PublisherWatch {
 public:
  /// A sentence when two publishers were found out by this scan; the next one comes after many scans only.
  std::optional<std::string> look(const TrackedScan& tracked);

 private:
  int silence_ = 0;      ///< scans until it may speak again
  bool fitted_ = false;  ///< the scan before
  int alternations_ = 0;
};

}  // namespace scanlock
