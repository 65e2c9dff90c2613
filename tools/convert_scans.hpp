// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
// Conversions of scans: a directory into a log, and a log into a directory or one cloud.
#pragma once

#include <algorithm>
#include <string>

#include "convert_options.hpp"
#include "io/scan_log.hpp"

namespace scanlock {

inline void report_scans(const ConvertOptions& options, const ScanConversion& result,
                         const std::string& channel) {
  if (result.rejected > 0)
    warn(options, std::to_string(result.rejected) + " messages on " + channel + " hold no scan (" +
                      result.first_error + ")");
  if (result.incomplete > 0)
    warn(options, std::to_string(result.incomplete) + " scans lack some of their sectors");
  if (!result.damage.empty()) warn(options, result.damage);
  report(options,
         {{"scans", result.scans},
          {"points", result.points},
          {"left_out_points", result.left_out_points},
          {"rejected", result.rejected},
          {"incomplete", result.incomplete},
          {"channel", channel}},
         std::to_string(result.scans) + " scans, " + std::to_string(result.points) + " points, channel " +
             channel);
}

enum class ScanTarget { kLog, kDirectory, kCloud };

inline void convert_scans(const ConvertOptions& options, ScanTarget target) {
  const std::string channel = options.channel.empty() ? "LIDAR" : options.channel;
  const auto type = std::find(kScanMessages.begin(), kScanMessages.end(), options.type);
  ScanConversion result;
  {
    ProgressBar bar(target == ScanTarget::kLog ? "scans" : "log");
    if (target == ScanTarget::kLog)
      result = directory_to_log(ScanDirectory(options.input, options.clock), options.output, channel,
                                static_cast<ScanMessage>(type - kScanMessages.begin()), bar.updater());
    else if (target == ScanTarget::kDirectory)
      result = log_to_directory(options.input, channel, options.output, bar.updater(), options.force,
                                "." + options.format);
    else
      result = log_to_cloud(options.input, channel, options.output, options.scan, bar.updater());
  }
  report_scans(options, result, channel);
}

}  // namespace scanlock
