// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Prints the contents of a log.
#pragma once

#include <cstdio>

#include "convert_options.hpp"
#include "io/lcm_log.hpp"
#include "io/log_info.hpp"

namespace scanlock {

inline Json info_json(const ConvertOptions& options, const LogInfo& info) {
  Json channels = Json::array();
  for (const ChannelInfo& c : info.channels)
    channels.push_back({{"name", c.name},
                        {"type", c.type},
                        {"events", c.events},
                        {"bytes", c.bytes},
                        {"first_utime", c.first_utime},
                        {"last_utime", c.last_utime},
                        {"rate_hz", c.rate_hz},
                        {"gaps", c.gaps},
                        {"largest_gap_s", c.largest_gap_s},
                        {"backward_steps", c.backward_steps}});
  return {{"file", options.input},
          {"events", info.events},
          {"duration_s", info.duration_s},
          {"damaged_places", info.damaged_places},
          {"skipped_bytes", info.skipped_bytes},
          {"truncated", info.truncated},
          {"channels", channels}};
}

inline void show_info(const ConvertOptions& options) {
  check_log(options.input);
  LogInfo info;
  {
    ProgressBar bar("log");
    info = inspect_log(options.input, bar.updater());
  }
  if (options.json) {
    print_json(info_json(options, info));
    return;
  }
  std::printf("%s: %zu events, %.3f s\n", options.input.c_str(), info.events, info.duration_s);
  if (info.damaged_places > 0)
    std::printf("DAMAGED at %lld place(s), %lld bytes skipped\n", static_cast<long long>(info.damaged_places),
                static_cast<long long>(info.skipped_bytes));
  if (info.truncated) std::printf("TRUNCATED: the last event is cut short\n");
  if (info.channels.empty()) return;
  std::printf("%-28s %8s %10s %9s %6s %9s  %s\n", "channel", "events", "MB", "rate Hz", "gaps", "longest s",
              "type");
  for (const ChannelInfo& c : info.channels) {
    std::printf("%-28s %8zu %10.3f %9.2f %6zu %9.3f  %s\n", c.name.c_str(), c.events,
                static_cast<double>(c.bytes) * 1e-6, c.rate_hz, c.gaps, c.largest_gap_s, c.type.c_str());
    if (c.backward_steps > 0)
      std::printf("%-28s %zu events are stamped before the preceding event\n", "", c.backward_steps);
  }
}

}  // namespace scanlock
