// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace scanlock {

/// What one channel of a log holds. Times are those of the log's events.
struct ChannelInfo {
  std::string name;
  std::string type;  ///< "bot_core.pose_t", or "unknown 0123456789abcdef"; several are separated by commas
  std::size_t events = 0;
  std::uint64_t bytes = 0;                       ///< of the messages
  std::int64_t first_utime = 0, last_utime = 0;  ///< microseconds: smallest and largest
  double rate_hz =
      0;  ///< from the median interval (the sectors of a scan are one event); 0 with fewer than two
  double largest_gap_s = 0;
  std::size_t gaps = 0;            ///< intervals longer than two and a half medians
  std::size_t backward_steps = 0;  ///< events stamped before the one in front of them
};

struct LogInfo {
  std::vector<ChannelInfo> channels;  ///< by name
  std::size_t events = 0;
  double duration_s = 0;  ///< from the earliest stamp to the latest
  std::int64_t damaged_places = 0, skipped_bytes = 0;
  bool truncated = false;
};

/// Reads the log as far as it goes. Throws std::runtime_error only when the file cannot be read at all.
LogInfo inspect_log(const std::string& path,
                    const std::function<void(std::uint64_t, std::uint64_t)>& progress);

}  // namespace scanlock
