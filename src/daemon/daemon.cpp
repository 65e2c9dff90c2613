// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/daemon.hpp"

#include <future>
#include <stdexcept>

#include "daemon/lcm_url.hpp"
#include "daemon/replay.hpp"
#include "daemon/silence.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostCommands = 64;  // waiting at a time; people and scripts send one

/// How often the publishing thread checks the stop signal while no scan arrives.
constexpr std::chrono::milliseconds kCoarse{50};

/// Throws ConfigError for a URL that can never work.
Pipeline::Mode mode_of(const DaemonConfig& config) {
  const std::string url = input_url(config);
  check_url(url);
  check_url(output_url(config));
  if (!is_log_url(url)) return Pipeline::Mode::kLive;
  replay_options(url);
  return Pipeline::Mode::kReplay;
}

}  // namespace

Daemon::Daemon(const Config& config, const std::string& version)
    : config_(config),
      version_(version),
      pipeline_(config_, statistics_, mode_of(config_.daemon)),
      sink_(open_sink(output_url(config_.daemon), statistics_)),
      inbox_(kMostCommands) {}

void Daemon::run(StopSignal& stop) {
  if (is_log_url(input_url(config_.daemon))) {
    replay(stop);
  } else {
    serve(stop);
  }
  sink_->close();
}

void Daemon::replay(const StopSignal& stop) {
  Replay replay(replay_options(input_url(config_.daemon)), config_, version_, pipeline_, statistics_, *sink_);
  replay.run(stop, nullptr, nullptr);
  pipeline_.finish();
  if (const std::string damage = replay.damage(); !damage.empty()) statistics_.complain(damage);
  if (const std::string why = replay.why_no_scan(); !why.empty() && !stop.requested())
    throw std::runtime_error(why);
}

void Daemon::serve(StopSignal& stop) {
  Receiver receiver(config_.daemon, inbox_, statistics_, stop);
  // A stage that fails ends the other stages, so that none waits for ever for its input.
  const auto guarded = [&](auto&& stage) {
    try {
      stage();
    } catch (...) {
      stop.request();
      inbox_.close();
      finished_.close();
      throw;
    }
  };
  std::future<void> receiving = std::async(std::launch::async, [&] { guarded([&] { receiver.run(); }); });
  std::future<void> working = std::async(std::launch::async, [&] {
    guarded([&] { work(); });
    finished_.finish();
  });
  guarded([&] { publish_until_the_end(stop); });
  working.get();
  receiving.get();
}

void Daemon::work() {
  while (const auto item = inbox_.take()) {
    busy_since_ = Clock::now();
    if (const auto* command = std::get_if<Command>(&*item))
      pipeline_.execute(*command);
    else
      finished_.put(pipeline_.process(std::get<ReceivedScan>(*item)));
    pipeline_.save_map_when_due();
    busy_since_ = Clock::time_point{};
  }
  pipeline_.finish();
}

Clock::duration Daemon::busy() const {
  const Clock::time_point since = busy_since_;
  return since == Clock::time_point{} ? Clock::duration::zero() : Clock::now() - since;
}

void Daemon::publish_until_the_end(const StopSignal& stop) {
  Outputs outputs(config_.daemon, version_, statistics_, *sink_, Pipeline::Mode::kLive);
  const auto period = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(config_.daemon.status_period_s));
  SilenceWatch silence(scan_channel_names(config_.daemon), config_.daemon.silence_warning_s, Clock::now());
  auto next_status = Clock::now();
  manager_.ready();
  while (!finished_.ended()) {
    if (stop.requested()) inbox_.close();  // the worker finishes its current scan and takes no other
    const auto now = Clock::now();
    manager_.alive(now, busy());
    if (now >= next_status) {
      outputs.publish_status();
      next_status = now + period;
    }
    if (const auto line = silence.look(statistics_.report().counters, now))
      statistics_.say(line->warning ? LogLevel::kWarning : LogLevel::kInfo, line->text);
    if (const auto finished = finished_.take_until(std::min(next_status, now + kCoarse)))
      outputs.publish(*finished);
  }
  manager_.stopping();
  outputs.publish_status();  // the final status
}

}  // namespace scanlock
