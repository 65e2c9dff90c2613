// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "daemon/config.hpp"
#include "daemon/inbox.hpp"
#include "daemon/log.hpp"
#include "daemon/prior_intake.hpp"
#include "daemon/statistics.hpp"
#include "daemon/stop_signal.hpp"
#include "messages/reports.hpp"
#include "messages/sector_assembler.hpp"

namespace scanlock {

/// A scan on its way from the socket to the worker.
struct ReceivedScan {
  Scan scan;
  PriorSample prior;                              ///< what other sensors say of its instant
  std::int32_t seq = 0;                           ///< the sender's own count
  std::int64_t recv_utime = 0;                    ///< microseconds, wall clock
  std::chrono::steady_clock::time_point arrival;  ///< when its handler was entered
  double decode_ms = 0;
};

using WorkInbox = Inbox<ReceivedScan, Command>;

/// The receiving thread: takes messages off LCM, validates them, and keeps the freshest scan and all commands
/// for the worker. From a log (file://) every scan waits for its turn, and `run` returns at the end of the
/// log.
class Receiver {
 public:
  Receiver(const DaemonConfig& config, WorkInbox& inbox, Statistics& statistics, const StopSignal& stop);

  /// The thread's body. Throws std::runtime_error when a log cannot be opened; everything else is retried
  /// until the stop signal.
  void run();

 private:
  std::unique_ptr<lcm::LCM> connect();
  std::unique_ptr<lcm::LCM> try_connect();
  void listen(lcm::LCM& lcm);
  void on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel);
  void on_bytes(const lcm::ReceiveBuffer& buffer, const std::string& channel);
  void on_command(const lcm::ReceiveBuffer* buffer, const std::string& channel);
  void on_prior(const lcm::ReceiveBuffer* buffer, const std::string& channel);
  void on_scan(DecodedScan decoded, ReceivedScan received, const std::string& channel);
  void flush();
  void say_how_times_are_read(const DecodedScan& decoded, const std::string& channel);
  void reject(DecodeFault fault, const std::string& sentence);
  void reject_command(const std::string& sentence);
  void complain_of_prior(std::int64_t Counters::*counter, const std::string& sentence);
  void watch_sockets();

  const DaemonConfig& config_;
  const std::string url_;
  const bool from_log_;
  WorkInbox& inbox_;
  Statistics& statistics_;
  const StopSignal& stop_;
  const DecodeLimits limits_;
  std::map<std::string, SectorAssembler> assemblers_;  ///< one for each scan channel
  PriorIntake priors_;
  std::set<int> sockets_;           ///< those that LCM receives with
  std::int64_t drops_counted_ = 0;  ///< of `sockets_`
  std::map<std::string, std::string>
      times_said_;  ///< by channel; drivers that change their minds are heard again
  Throttle times_{std::chrono::seconds(1)};
  Throttle rejections_{std::chrono::seconds(10)}, untimed_{std::chrono::seconds(60)},
      drops_{std::chrono::seconds(10)}, prior_faults_{std::chrono::seconds(10)};
};

}  // namespace scanlock
