// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/worker.hpp"

#include <array>
#include <exception>

#include "daemon/lcm_url.hpp"
#include "daemon/log.hpp"
#include "daemon/mount.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

float milliseconds(Clock::duration duration) {
  return std::chrono::duration<float, std::milli>(duration).count();
}

const char* name_of(CommandKind kind) {
  switch (kind) {
    case CommandKind::kSetPose:
      return "set pose";
    case CommandKind::kReset:
      return "reset";
    case CommandKind::kSaveMap:
      return "save map";
    case CommandKind::kLoadMap:
      return "load map";
  }
  return "?";
}

}  // namespace

Worker::Worker(const Config& config, WorkInbox& inbox, Slot<FinishedScan>& finished, Statistics& statistics)
    : body_from_sensor_(body_from_sensor(config.daemon.mount)),
      inbox_(inbox),
      finished_(finished),
      statistics_(statistics),
      maps_(config.daemon.map, statistics),
      tracker_(config.tracker),
      judge_(body_from_sensor_),
      search_(is_log_url(input_url(config.daemon))) {
  if (std::optional<SavedMap> saved = maps_.load_at_start()) tracker_.load(std::move(*saved));
}

void Worker::run() {
  try {
    work();
  } catch (...) {
    finished_.finish();  // the publishing thread must not wait for ever
    throw;
  }
  finished_.finish();
}

void Worker::work() {
  while (const auto item = inbox_.take()) {
    std::visit([this](const auto& arrived) { handle(arrived); }, *item);
    if (maps_.is_due(Clock::now())) maps_.save_if_grown(tracker_.save());
  }
  maps_.save_at_exit(tracker_.save());
}

void Worker::handle(const ReceivedScan& received) {
  try {
    if (auto answer = search_.poll()) tracker_.give(std::move(*answer));
    finished_.put(track(received));
    if (auto request = tracker_.take_request()) search_.start(std::move(*request));
  } catch (const std::exception& error) {  // out of memory, at most; the next scan begins anew
    statistics_.set_error(std::string("a scan could not be tracked: ") + error.what());
    log_line(LogLevel::kError, std::string("a scan could not be tracked, starting anew: ") + error.what());
    tracker_.reset();
  }
}

TrackedScan Worker::track_with_prior(const ReceivedScan& received) {
  TrackedScan tracked = tracker_.track(received.scan, judge_.prior(received.prior));
  const std::int64_t before = judge_.contradictions();
  const auto sentence = judge_.learn(received.prior, tracked);
  statistics_.count(&Counters::priors_contradicting, judge_.contradictions() - before);
  if (sentence) {
    statistics_.set_error(*sentence);
    log_line(LogLevel::kWarning, *sentence);
  }
  return tracked;
}

FinishedScan Worker::track(const ReceivedScan& received) {
  FinishedScan finished;
  std::array<float, 3> stages{};
  auto mark = Clock::now();
  finished.scan_seq = received.seq;
  finished.recv_utime = received.recv_utime;
  finished.arrival = received.arrival;
  finished.times.decode_ms = static_cast<float>(received.decode_ms);
  finished.times.wait_ms = milliseconds(mark - received.arrival) - finished.times.decode_ms;
  tracker_.set_stage_observer([&](Stage stage) {
    const auto now = Clock::now();
    stages[static_cast<std::size_t>(stage)] += milliseconds(now - mark);
    mark = now;
  });
  finished.tracked = seen_from_body(track_with_prior(received), body_from_sensor_);
  tracker_.set_stage_observer(nullptr);
  finished.times.preprocess_ms = stages[0];
  finished.times.align_ms = stages[1];
  finished.times.map_ms = stages[2];
  return finished;
}

void Worker::handle(const Command& command) {
  const std::string what = std::string("command to ") + name_of(command.kind);
  try {
    execute(command);
    statistics_.count(&Counters::commands);
    log_line(LogLevel::kInfo, what + " taken");
  } catch (const std::exception& error) {
    statistics_.count(&Counters::commands_rejected);
    statistics_.set_error(what + " rejected: " + error.what());
    log_line(LogLevel::kError, what + " rejected: " + error.what());
  }
}

void Worker::execute(const Command& command) {
  const Pose& mount = body_from_sensor_;
  switch (command.kind) {
    case CommandKind::kSetPose:
      return tracker_.set_pose(mount.inverse() * command.map_from_body * mount);
    case CommandKind::kReset:
      return tracker_.reset();
    case CommandKind::kSaveMap:
      return maps_.save(command.path, tracker_.save());
    case CommandKind::kLoadMap:
      return tracker_.load(maps_.load(command.path));
  }
}

}  // namespace scanlock
