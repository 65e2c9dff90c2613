// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config.hpp"
#include "odometry/prior_buffer.hpp"

namespace scanlock {

/// Collects the messages of other sensors and interpolates them at the stamps of scans. The result depends on
/// the messages and scans and their order alone: to be used by the one thread that receives both.
class PriorIntake {
 public:
  explicit PriorIntake(const DaemonConfig& config);

  /// The configured channels.
  std::vector<std::string> channels() const;

  /// Takes a message of a configured channel; returns a sentence when the message cannot be used.
  std::optional<std::string> take(const std::string& channel, const std::uint8_t* data, std::size_t size);

  struct Reading {
    PriorSample sample;
    std::string fault;  ///< a sentence when a configured sensor has no measurement for this scan, or empty
  };
  /// The measurements of these sensors at the stamp of a scan.
  Reading read(std::int64_t scan_utime);

 private:
  struct Source {
    std::string channel;
    PriorBuffer buffer;
    int scans_without_any = 0;
  };
  std::optional<Pose> read(Source& source, std::int64_t scan_utime, std::string& fault);

  Source attitude_, odometry_;
};

}  // namespace scanlock
