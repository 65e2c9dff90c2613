// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <set>
#include <string>

#include "daemon/config.hpp"
#include "daemon/inbox.hpp"
#include "daemon/intake.hpp"
#include "daemon/statistics.hpp"
#include "daemon/stop_signal.hpp"

namespace scanlock {

using WorkInbox = Inbox<ReceivedScan, Command>;

/// The thread that receives from LCM: passes messages to the intake, and the newest scan and all commands to
/// the working thread.
class Receiver {
 public:
  Receiver(const DaemonConfig& config, WorkInbox& inbox, Statistics& statistics, const StopSignal& stop);

  /// The thread's function; runs until the stop signal. Temporary failures are retried; throws
  /// std::runtime_error for a URL that LCM will never accept.
  void run();

 private:
  std::unique_ptr<lcm::LCM> connect();
  std::unique_ptr<lcm::LCM> try_connect();
  void subscribe(lcm::LCM& lcm);
  void settle_receive_buffer(const std::set<int>& before, int port);
  void listen(lcm::LCM& lcm);
  void on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel);
  void hand_over(ReceivedScan&& scan);
  void hand_over(Command&& command);
  void watch_sockets();

  const DaemonConfig& config_;
  const std::string url_;
  WorkInbox& inbox_;
  Statistics& statistics_;
  const StopSignal& stop_;
  Intake intake_;
  std::set<int> sockets_;           ///< the sockets through which LCM receives
  std::int64_t drops_counted_ = 0;  ///< of `sockets_`
};

}  // namespace scanlock
