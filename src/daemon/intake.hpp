// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "daemon/config.hpp"
#include "daemon/prior_intake.hpp"
#include "daemon/publisher_watch.hpp"
#include "daemon/statistics.hpp"
#include "messages/decode_scan.hpp"
#include "messages/reports.hpp"
#include "messages/sector_assembler.hpp"

namespace scanlock {

/// A scan on its way from its message to the tracker.
struct ReceivedScan {
  Scan scan;
  PriorSample prior;            ///< what other sensors say of its instant
  std::int32_t seq = 0;         ///< the sender's own count; 0 where its type has none
  std::int64_t recv_utime = 0;  ///< microseconds: its arrival, or in a replay its event's time
  std::chrono::steady_clock::time_point arrival;
  double decode_ms = 0;
};

/// The first stage of the pipeline: message bytes in, scans and commands out. Decodes, joins sectors, stamps
/// what has no stamp, asks the other sensors, and counts whatever is rejected. What comes out depends on the
/// messages, their order and their times of arrival alone. For one thread.
class Intake {
 public:
  using Item = std::variant<ReceivedScan, Command>;

  Intake(const DaemonConfig& config, Statistics& statistics);

  /// The work that one message leads to, in order. `utime`: microseconds, its arrival, or in a replay the
  /// time of its event. Messages of channels that nobody asked for are ignored. Throws for lack of memory
  /// only.
  std::vector<Item> take(const std::string& channel, const std::uint8_t* data, std::size_t size,
                         std::int64_t utime);
  /// At the end of a log: scans that still wait for sectors.
  std::vector<Item> finish(std::int64_t utime);

  /// Of the other sensors that are configured.
  std::vector<std::string> prior_channels() const { return priors_.channels(); }

 private:
  void take_scan(const std::string& channel, DecodedScan decoded, ReceivedScan received,
                 std::vector<Item>& items);
  void stamp(const std::string& channel, ReceivedScan& received);
  void say_how_times_are_read(const std::string& channel, const DecodedScan& decoded);
  void count_sectors(const std::string& channel, const SectorAssembler& assembler, std::int64_t before);
  void watch_counts(const std::string& channel, const DecodedScan& decoded);

  const std::string command_channel_;
  const DecodeLimits limits_;
  Statistics& statistics_;
  std::map<std::string, SectorAssembler> assemblers_;  ///< one for each scan channel
  std::map<std::string, CountWatch> counts_;           ///< likewise
  PriorIntake priors_;
  std::map<std::string, std::string> times_said_;  ///< by channel; a driver that changes its mind is heard
};

}  // namespace scanlock
