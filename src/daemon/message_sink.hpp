// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <string>

#include "daemon/statistics.hpp"
#include "io/lcm_log.hpp"
#include "messages/encode.hpp"

namespace scanlock {

/// Receives the published messages.
class MessageSink {
 public:
  virtual ~MessageSink() = default;
  /// `utime`: microseconds, the time of the event when the sink is a log.
  virtual void send(std::int64_t utime, const std::string& channel, const Bytes& message) = 0;
  /// Throws std::runtime_error when sent messages could not be written.
  virtual void close() {}
};

/// An LCM network, which may become available later, or fail and return: lost messages are counted and
/// logged.
class NetworkSink final : public MessageSink {
 public:
  NetworkSink(std::string url, Statistics& statistics);
  void send(std::int64_t utime, const std::string& channel, const Bytes& message) override;

 private:
  bool connect();

  const std::string url_;
  Statistics& statistics_;
  std::unique_ptr<lcm::LCM> lcm_;
  std::chrono::steady_clock::time_point next_attempt_{};
};

/// An LCM log. Throws std::runtime_error when a write fails.
class LogSink final : public MessageSink {
 public:
  LogSink(const std::string& path, LogWriter::Mode mode) : writer_(path, mode) {}
  void send(std::int64_t utime, const std::string& channel, const Bytes& message) override {
    writer_.write(utime, channel, message);
  }
  void close() override { writer_.close(); }

 private:
  LogWriter writer_;
};

/// Throws ConfigError for a URL that messages can never be published to.
std::unique_ptr<MessageSink> open_sink(const std::string& url, Statistics& statistics);

}  // namespace scanlock
