// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/daemon.hpp"

#include <array>
#include <exception>
#include <future>
#include <utility>

#include "daemon/background_search.hpp"
#include "daemon/lcm_url.hpp"
#include "daemon/mount.hpp"
#include "daemon/silence.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

float milliseconds(Clock::duration duration) {
  return std::chrono::duration<float, std::milli>(duration).count();
}

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const auto& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

/// How often the publishing thread looks at the stop signal while no scan comes.
constexpr std::chrono::milliseconds kGlance{50};

}  // namespace

Daemon::Daemon(const Config& config, const std::string& version)
    : config_(config), outputs_(config_.daemon, version, statistics_) {}

void Daemon::run(const StopSignal& stop) {
  Receiver receiver(config_.daemon, scans_, statistics_, stop);
  std::future<void> receiving = std::async(std::launch::async, [&] {
    try {
      receiver.run();
    } catch (...) {
      scans_.finish();
      throw;
    }
  });
  std::future<void> working = std::async(std::launch::async, [this] { work(); });
  publish_until_the_end(stop);
  working.get();
  receiving.get();
}

void Daemon::work() {
  Tracker tracker(config_.tracker);
  BackgroundSearch search(is_log_url(input_url(config_.daemon)));
  while (auto received = scans_.take()) {
    try {
      if (auto answer = search.poll()) tracker.give(std::move(*answer));
      finished_.put(track(tracker, *received));
      if (auto request = tracker.take_request()) search.start(std::move(*request));
    } catch (const std::exception& error) {  // out of memory, at most; the next scan begins anew
      statistics_.set_error(std::string("a scan could not be tracked: ") + error.what());
      log_line(LogLevel::kError, std::string("a scan could not be tracked, starting anew: ") + error.what());
      tracker.reset();
    }
  }
  finished_.finish();
}

FinishedScan Daemon::track(Tracker& tracker, const ReceivedScan& received) {
  FinishedScan finished;
  std::array<float, 3> stages{};
  auto mark = Clock::now();
  finished.scan_seq = received.seq;
  finished.recv_utime = received.recv_utime;
  finished.arrival = received.arrival;
  finished.times.decode_ms = static_cast<float>(received.decode_ms);
  finished.times.wait_ms = milliseconds(mark - received.arrival) - finished.times.decode_ms;
  tracker.set_stage_observer([&](Stage stage) {
    const auto now = Clock::now();
    stages[static_cast<std::size_t>(stage)] += milliseconds(now - mark);
    mark = now;
  });
  finished.tracked = seen_from_body(tracker.track(received.scan), body_from_sensor(config_.daemon.mount));
  tracker.set_stage_observer(nullptr);
  finished.times.preprocess_ms = stages[0];
  finished.times.align_ms = stages[1];
  finished.times.map_ms = stages[2];
  return finished;
}

void Daemon::publish_until_the_end(const StopSignal& stop) {
  const auto period = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(config_.daemon.status_period_s));
  SilenceWatch silence(joined(config_.daemon.scan_channels), config_.daemon.silence_warning_s, Clock::now());
  auto next_status = Clock::now();
  while (!finished_.ended()) {
    if (stop.requested()) scans_.close();  // the worker finishes the scan at hand, and no other
    const auto now = Clock::now();
    if (now >= next_status) {
      outputs_.publish_status();
      next_status = now + period;
    }
    if (const auto line = silence.look(statistics_.report().counters, now)) {
      log_line(line->warning ? LogLevel::kWarning : LogLevel::kInfo, line->text);
    }
    if (const auto finished = finished_.take_until(std::min(next_status, now + kGlance)))
      outputs_.publish(*finished);
  }
  outputs_.publish_status();  // the last word
}

}  // namespace scanlock
