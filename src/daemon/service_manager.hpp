// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>

namespace scanlock {

/// The daemon's side of sd_notify(3): sends each message as a datagram to the socket named by NOTIFY_SOCKET.
/// Without that variable, or when the socket does not accept the datagram, nothing happens.
class ServiceManager {
 public:
  using Clock = std::chrono::steady_clock;

  /// Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID from the environment.
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  /// To be called when the map is loaded and the daemon receives.
  void ready();
  void stopping();
  /// To be called several times a second. Reports four times per watchdog period that the daemon works,
  /// unless the worker has been busy with one item for longer than a whole period (`busy`).
  void alive(Clock::time_point now, Clock::duration busy);

 private:
  void send(const std::string& message) const;

  int socket_ = -1;
  std::string address_;                    ///< sun_path; an abstract address begins with a zero byte
  std::chrono::microseconds watchdog_{0};  ///< watchdog period; 0: none
  Clock::time_point next_alive_{};
};

}  // namespace scanlock
