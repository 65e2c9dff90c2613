// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "odometry/tracked_scan.hpp"

namespace scanlock {

// Two publishers on one channel are a common mistake, for instance a log that is replayed beside a live
// driver. They can be recognised by their sequence numbers, by stamps of two clocks, or because every other
// scan is of another place.

/// Recognises two publishers by the sequence numbers of their scans.
class CountWatch {
 public:
  /// Takes the sequence number of one message (0 where its type has none; of a sector, that of its scan).
  /// True when the numbers of the last ten messages alternate between two senders.
  bool interleaves(std::int32_t count, bool sector);
  /// The last two sequence numbers, for a sentence.
  std::string counts() const;

 private:
  std::array<std::int32_t, 2> last_{};  ///< the newer one last
  int interleaved_ = 0;
};

/// Recognises two publishers by the results of tracking.
class PublisherWatch {
 public:
  /// A sentence when this scan shows that there are two publishers; repeated only after 1000 scans.
  std::optional<std::string> look(const TrackedScan& tracked);

 private:
  int silence_ = 0;      ///< scans until the next report is permitted
  bool fitted_ = false;  ///< whether the previous scan fitted the map
  int alternations_ = 0;
};

}  // namespace scanlock
