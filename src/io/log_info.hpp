// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace scanlock {

/// Contents of one channel of a log. Times are the receive times (utime) of the log's events.
struct ChannelInfo {
  std::string name;
  std::string type;  ///< "bot_core.pose_t", or "unknown 0123456789abcdef"; several types are separated by
                     ///< commas
  std::size_t events = 0;
  std::uint64_t bytes = 0;                       ///< sum over the messages
  std::int64_t first_utime = 0, last_utime = 0;  ///< microseconds: smallest and largest
  double rate_hz =
      0;  ///< 1 / median interval, the sectors of a scan counting as one event; 0 with fewer than two events
  double largest_gap_s = 0;
  std::size_t gaps = 0;            ///< intervals longer than 2.5 medians
  std::size_t backward_steps = 0;  ///< events with a utime below that of the previous event
};

struct LogInfo {
  std::vector<ChannelInfo> channels;  ///< by name
  std::size_t events = 0;
  double duration_s = 0;  ///< from the earliest event to the latest
  std::int64_t damaged_places = 0, skipped_bytes = 0;
  bool truncated = false;
};

/// Reads as much of the log as is readable. Throws std::runtime_error only when the file cannot be read at
/// all. `progress`: bytes read, and bytes in total.
LogInfo inspect_log(const std::string& path,
                    const std::function<void(std::uint64_t, std::uint64_t)>& progress);

}  // namespace scanlock
