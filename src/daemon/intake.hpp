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

/// A decoded scan on its way to the tracker.
struct ReceivedScan {
  Scan scan;
  PriorSample prior;            ///< measurements of other sensors at its stamp
  std::int32_t seq = 0;         ///< the sender's sequence number; 0 where the type has none
  std::int64_t recv_utime = 0;  ///< microseconds: time of arrival; in a replay, time of the log event
  std::chrono::steady_clock::time_point arrival;
  double decode_ms = 0;
};

/// The first stage of the pipeline: converts message bytes to scans and commands. Decodes, joins sectors,
/// stamps scans that have no stamp, adds the measurements of other sensors, and counts rejected messages. The
/// result depends only on the messages, their order and their times of arrival. To be used by one thread.
class Intake {
 public:
  using Item = std::variant<ReceivedScan, Command>;

  Intake(const DaemonConfig& config, Statistics& statistics);

  /// The scans and commands that one message produces, in order. `utime`: microseconds, its time of arrival;
  /// in a replay, the time of its event. Messages on channels that are not configured are ignored. Throws
  /// only when memory runs out.
  std::vector<Item> take(const std::string& channel, const std::uint8_t* data, std::size_t size,
                         std::int64_t utime);
  /// At the end of a log: the scans that still wait for sectors.
  std::vector<Item> finish(std::int64_t utime);

  /// The configured channels of other sensors.
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
  std::map<std::string, SectorAssembler> assemblers_;  ///< one per scan channel
  std::map<std::string, CountWatch> counts_;           ///< one per scan channel
  PriorIntake priors_;
  std::map<std::string, std::string> times_said_;  ///< by channel: the last sentence that was logged
};

}  // namespace scanlock
