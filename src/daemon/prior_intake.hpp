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

/// The messages of other sensors on their way to a scan. What it says depends on the messages and the scans
/// in their order alone: for the one thread that receives both.
class PriorIntake {
 public:
  explicit PriorIntake(const DaemonConfig& config);

  /// The channels that are configured.
  std::vector<std::string> channels() const;

  /// Takes a message of one of them; a sentence when it is of no use.
  std::optional<std::string> take(const std::string& channel, const std::uint8_t* data, std::size_t size);

  struct Reading {
    PriorSample sample;
    std::string fault;  ///< a sentence when a configured sensor says nothing of this scan, or empty
  };
  /// What they say of the instant at which a scan is stamped.
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
