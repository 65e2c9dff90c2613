// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/log_info.hpp"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <map>
#include <set>

#include "io/lcm_log.hpp"
#include "messages/fingerprints.hpp"

namespace scanlock {
namespace {

constexpr double kGapFactor = 2.5;  // above 2, the interval around one missing event, by a margin for jitter

struct Collected {
  std::set<std::uint64_t> types;
  std::vector<std::int64_t> utimes;  // of events; of the sectors of one scan, only the first
  std::vector<std::uint8_t> last_scan;
  std::size_t events = 0;
  std::uint64_t bytes = 0;
};

std::string type_names(const std::set<std::uint64_t>& types) {
  std::string names;
  for (const std::uint64_t type : types) {
    if (!names.empty()) names += ", ";
    if (const char* known = type_name(type)) {
      names += known;
    } else {
      std::array<char, 32> text{};
      std::snprintf(text.data(), text.size(), "unknown %016" PRIx64, type);
      names += text.data();
    }
  }
  return names;
}

double to_seconds(std::int64_t from, std::int64_t to) {
  return (static_cast<double>(to) - static_cast<double>(from)) * 1e-6;  // damaged stamps may be 2^63 apart
}

void measure_intervals(const std::vector<std::int64_t>& utimes, ChannelInfo& info) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < utimes.size(); ++i) {
    if (utimes[i] < utimes[i - 1])
      ++info.backward_steps;
    else
      intervals.push_back(to_seconds(utimes[i - 1], utimes[i]));
  }
  if (intervals.empty()) return;
  std::sort(intervals.begin(), intervals.end());
  const double median = intervals[intervals.size() / 2];
  info.rate_hz = median > 0 ? 1 / median : 0;
  info.largest_gap_s = intervals.back();
  if (median > 0)
    info.gaps = static_cast<std::size_t>(
        std::count_if(intervals.begin(), intervals.end(), [&](double s) { return s > kGapFactor * median; }));
}

/// Adds an event. Consecutive sectors of one scan (equal fingerprint and equal utime, the first 16 bytes)
/// count as one event in the intervals: otherwise the pause between two scans would be counted as a gap.
void collect(const LogEvent& event, Collected& channel) {
  constexpr std::size_t kFingerprintAndUtime = 16;
  const std::uint64_t type = message_fingerprint(event.data.data(), event.data.size());
  channel.types.insert(type);
  channel.bytes += event.data.size();
  ++channel.events;
  if (type == fingerprint::kScanSector && event.data.size() >= kFingerprintAndUtime) {
    const std::vector<std::uint8_t> scan(event.data.begin(), event.data.begin() + kFingerprintAndUtime);
    if (scan == channel.last_scan) return;
    channel.last_scan = scan;
  }
  channel.utimes.push_back(event.utime);
}

}  // namespace

LogInfo inspect_log(const std::string& path,
                    const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  LogReader reader(path);
  std::map<std::string, Collected> channels;
  LogInfo info;
  while (const auto event = reader.next()) {
    collect(*event, channels[event->channel]);
    ++info.events;
    progress(reader.position(), reader.file_size());
  }
  std::int64_t first = 0, last = 0;
  for (const auto& [name, collected] : channels) {
    ChannelInfo channel;
    channel.name = name;
    channel.type = type_names(collected.types);
    channel.events = collected.events;
    channel.bytes = collected.bytes;
    const auto [low, high] = std::minmax_element(collected.utimes.begin(), collected.utimes.end());
    channel.first_utime = *low;
    channel.last_utime = *high;
    measure_intervals(collected.utimes, channel);
    first = info.channels.empty() ? *low : std::min(first, *low);
    last = info.channels.empty() ? *high : std::max(last, *high);
    info.channels.push_back(channel);
  }
  info.duration_s = to_seconds(first, last);
  info.damaged_places = reader.damaged_places();
  info.skipped_bytes = reader.skipped_bytes();
  info.truncated = reader.truncated();
  return info;
}

}  // namespace scanlock
