// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/daemon.hpp"

#include <future>

#include "daemon/lcm_url.hpp"
#include "daemon/silence.hpp"
#include "daemon/worker.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const auto& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

constexpr std::size_t kMostCommands = 64;  // that wait; people and scripts send one

/// How often the publishing thread looks at the stop signal while no scan comes.
constexpr std::chrono::milliseconds kGlance{50};

}  // namespace

Daemon::Daemon(const Config& config, const std::string& version)
    : config_(config), outputs_(config_.daemon, version, statistics_), inbox_(kMostCommands) {}

void Daemon::run(const StopSignal& stop) {
  Worker worker(config_, inbox_, finished_, statistics_);
  Receiver receiver(config_.daemon, inbox_, statistics_, stop);
  std::future<void> receiving = std::async(std::launch::async, [&] {
    try {
      receiver.run();
    } catch (...) {
      inbox_.finish();
      throw;
    }
  });
  std::future<void> working = std::async(std::launch::async, [&] { worker.run(); });
  publish_until_the_end(stop);
  working.get();
  receiving.get();
}

void Daemon::publish_until_the_end(const StopSignal& stop) {
  const auto period = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(config_.daemon.status_period_s));
  SilenceWatch silence(joined(config_.daemon.scan_channels), config_.daemon.silence_warning_s, Clock::now());
  const bool live = !is_log_url(input_url(config_.daemon));  // a log waits as long as a scan takes
  auto next_status = Clock::now();
  while (!finished_.ended()) {
    if (stop.requested()) inbox_.close();  // the worker finishes the scan at hand, and no other
    const auto now = Clock::now();
    if (now >= next_status) {
      outputs_.publish_status();
      next_status = now + period;
    }
    if (const auto line = silence.look(statistics_.report().counters, now); line && live) {
      log_line(line->warning ? LogLevel::kWarning : LogLevel::kInfo, line->text);
    }
    if (const auto finished = finished_.take_until(std::min(next_status, now + kGlance)))
      outputs_.publish(*finished);
  }
  outputs_.publish_status();  // the last word
}

}  // namespace scanlock
