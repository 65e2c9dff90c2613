// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/replay.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "daemon/lcm_url.hpp"
#include "messages/fingerprints.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

double number_in(const std::string& url, const std::string& key, double standard) {
  const std::optional<std::string> text = url_option(url, key);
  if (!text) return standard;
  char* end = nullptr;
  const double value = std::strtod(text->c_str(), &end);
  if (text->empty() || *end != '\0' || !(value >= 0) || !std::isfinite(value))
    throw ConfigError(url + ": " + key + "=" + *text + " is not a number of 0 or more");
  return value;
}

}  // namespace

ReplayOptions replay_options(const std::string& url) {
  return {log_url_path(url), number_in(url, "speed", 1),
          static_cast<std::int64_t>(std::min(number_in(url, "start_timestamp", 0), 9e18))};
}

Replay::Replay(const ReplayOptions& options, const Config& config, const std::string& version,
               Pipeline& pipeline, Statistics& statistics, MessageSink& sink)
    : options_(options),
      config_(config),
      statistics_(statistics),
      reader_(options.log_path),
      intake_(config.daemon, statistics),
      pipeline_(pipeline),
      outputs_(config_.daemon, version, statistics, sink, Pipeline::Mode::kReplay) {}

void Replay::run(const StopSignal& stop, const ScanObserver& observer,
                 const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  std::int64_t utime = 0;
  while (!stop.requested()) {
    const std::optional<LogEvent> event = reader_.next();
    if (!event) break;
    if (event->utime < options_.first_utime) continue;
    if (!wait_for(*event, stop)) break;
    utime = event->utime;
    statistics_.set_replay_time(utime);
    note_other_channel(*event);
    handle(intake_.take(event->channel, event->data.data(), event->data.size(), utime), observer);
    if (progress) progress(reader_.position(), reader_.file_size());
  }
  if (!stop.requested()) handle(intake_.finish(utime), observer);
  outputs_.publish_status();  // the final status
}

void Replay::handle(std::vector<Intake::Item> items, const ScanObserver& observer) {
  for (Intake::Item& item : items) {
    if (const auto* command = std::get_if<Command>(&item)) {
      pipeline_.execute(*command);
      continue;
    }
    const ReceivedScan& received = std::get<ReceivedScan>(item);
    const FinishedScan finished = pipeline_.process(received);
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - received.arrival).count();
    outputs_.publish(finished);
    if (observer) observer(finished, ms);
  }
}

/// Waits until the event is due at the configured speed; does not wait at speed 0. False when the stop signal
/// came.
bool Replay::wait_for(const LogEvent& event, const StopSignal& stop) {
  if (!(options_.speed > 0)) return true;
  const auto now = Clock::now();
  // When the recording's clock steps by more than 60 s, there is no wait; the pace restarts at this event.
  const double since = 1e-6 * (static_cast<double>(event.utime) - static_cast<double>(begin_utime_));
  const std::chrono::duration<double> ahead(since / options_.speed -
                                            std::chrono::duration<double>(now - begin_).count());
  constexpr double kLongestWait = 60;  // seconds
  if (begin_utime_ == 0 || ahead.count() > kLongestWait || ahead.count() < -kLongestWait) {
    begin_utime_ = event.utime;
    begin_ = now;
    return true;
  }
  if (ahead.count() <= 0) return true;
  return !stop.wait_for(std::chrono::duration_cast<std::chrono::milliseconds>(ahead));
}

void Replay::note_other_channel(const LogEvent& event) {
  constexpr std::size_t kMost = 20;
  const std::vector<std::string>& listened = config_.daemon.scan_channels;
  if (std::find(listened.begin(), listened.end(), event.channel) != listened.end() ||
      other_scans_.size() >= kMost || other_scans_.count(event.channel) > 0)
    return;
  const std::uint64_t type = message_fingerprint(event.data.data(), event.data.size());
  if (is_scan_type(type)) other_scans_[event.channel] = type_name(type);
}

std::string Replay::damage() const {
  if (reader_.damaged_places() == 0 && !reader_.truncated()) return "";
  return options_.log_path + ": " + std::to_string(reader_.damaged_places()) + " damaged places, " +
         std::to_string(reader_.skipped_bytes()) + " bytes skipped" +
         (reader_.truncated() ? ", the last event is cut short" : "");
}

std::string Replay::why_no_scan() const {
  const Counters counters = statistics_.report().counters;
  if (counters.used > 0) return "";
  const std::string log =
      (damage().empty() ? options_.log_path + ": " : damage() + "; ") + "no scan could be used: ";
  if (counters.received > 0)
    return log + std::to_string(counters.received) + " came on " + scan_channel_names(config_.daemon) +
           ", the last one was rejected: " + counters.last_error;
  if (other_scans_.empty())
    return log + "none of its channels carries scans; `scanlock-convert LOG --info` lists what they carry";
  std::string carry;
  for (const auto& [channel, type] : other_scans_)
    carry += (carry.empty() ? "" : ", ") + channel + " (" + type + ")";
  return log + "nothing came on " + scan_channel_names(config_.daemon) + "; scans are on " + carry +
         ": choose with --scan-channel";
}

}  // namespace scanlock
