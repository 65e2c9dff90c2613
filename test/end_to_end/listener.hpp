// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <bot_core/pose_t.hpp>
#include <chrono>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <scanlock/odometry_t.hpp>
#include <scanlock/status_t.hpp>
#include <string>
#include <vector>

namespace scanlock::test {

/// An LCM program that publishes and subscribes.
class Listener {
 public:
  explicit Listener(const std::string& url) : lcm_(url) {
    lcm_.subscribe("SCANLOCK_STATUS", &Listener::on_status, this);
    lcm_.subscribe("SCANLOCK_ODOMETRY", &Listener::on_odometry, this);
    lcm_.subscribe("POSE_BODY_CORRECTED", &Listener::on_pose, this);
  }

  /// Listens until `done()`; false when that does not happen within `patience`.
  bool until(const std::function<bool()>& done,
             std::chrono::milliseconds patience = std::chrono::seconds(10)) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!done()) {
      if (std::chrono::steady_clock::now() > end) return false;
      lcm_.handleTimeout(20);
    }
    return true;
  }

  /// Waits until the daemon's status shows that its socket receives.
  bool until_ready() {
    return until([this] { return statuses > 0 && status.recv_buf_granted > 0; });
  }

  void publish(const std::string& channel, const std::vector<std::uint8_t>& bytes) {
    lcm_.publish(channel, bytes.data(), static_cast<unsigned>(bytes.size()));
  }

  ::scanlock::status_t status{};  ///< the last status
  int statuses = 0;
  std::vector<::scanlock::odometry_t> odometry;
  std::vector<bot_core::pose_t> poses;

 private:
  void on_status(const lcm::ReceiveBuffer*, const std::string&, const ::scanlock::status_t* message) {
    status = *message;
    ++statuses;
  }
  void on_odometry(const lcm::ReceiveBuffer*, const std::string&, const ::scanlock::odometry_t* message) {
    odometry.push_back(*message);
  }
  void on_pose(const lcm::ReceiveBuffer*, const std::string&, const bot_core::pose_t* message) {
    poses.push_back(*message);
  }

  lcm::LCM lcm_;
};

}  // namespace scanlock::test
