// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>

namespace scanlock {

/// The daemon's side of sd_notify(3): a datagram to the socket that NOTIFY_SOCKET names, for each message.
/// Where no service manager asks for them, and where it does not take them, nothing happens.
class ServiceManager {
 public:
  using Clock = std::chrono::steady_clock;

  /// From NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID of the environment.
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  /// The map is loaded, and scans are listened for.
  void ready();
  void stopping();
  /// To be called several times a second: tells four times in a watchdog period that the daemon works, unless
  /// the item at hand has been worked on for a whole period (`busy`).
  void alive(Clock::time_point now, Clock::duration busy);

 private:
  void send(const std::string& message) const;

  int socket_ = -1;
  std::string address_;                    ///< sun_path; begins with a zero byte where it is abstract
  std::chrono::microseconds watchdog_{0};  ///< 0: none
  Clock::time_point next_alive_{};
};

}  // namespace scanlock
