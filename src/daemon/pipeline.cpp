// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/pipeline.hpp"

#include <array>
#include <exception>
#include <stdexcept>
#include <utility>

#include "daemon/mount.hpp"
#include "mapping/submap.hpp"

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

Pipeline::Pipeline(const Config& config, Statistics& statistics, Mode mode)
    : mode_(mode),
      body_from_sensor_(body_from_sensor(config.daemon.mount)),
      statistics_(statistics),
      maps_(config, statistics),
      mapper_(config.tracker),
      consistency_(body_from_sensor_),
      search_(config.tracker, mode == Mode::kReplay) {
  if (auto loaded = maps_.load_at_start()) mapper_.load(std::move(loaded->map), loaded->fixed);
  while (auto request = mapper_.take_request()) mapper_.give(search_.work(*request));
}

FinishedScan Pipeline::process(const ReceivedScan& received) {
  FinishedScan finished;
  finished.scan_seq = received.seq;
  finished.recv_utime = received.recv_utime;
  finished.arrival = received.arrival;
  finished.tracked.utime = received.scan.utime;
  try {
    if (auto answer = search_.poll()) mapper_.give(std::move(*answer));
    track(received, &finished);
    if (auto request = mapper_.take_request()) search_.start(std::move(*request));
  } catch (const std::exception& error) {  // lack of memory only; tracking restarts with the next scan
    statistics_.complain(std::string("a scan could not be tracked, starting a new map: ") + error.what());
    mapper_.reset();
    finished.tracked.verdict = ScanVerdict::kEmpty;
    finished.tracked.why = error.what();
  }
  note_clock(finished.tracked);
  return finished;
}

void Pipeline::track(const ReceivedScan& received, FinishedScan* finished) {
  std::array<float, 3> stages{};
  auto mark = Clock::now();
  finished->times.decode_ms = static_cast<float>(received.decode_ms);
  finished->times.wait_ms = milliseconds(mark - received.arrival) - finished->times.decode_ms;
  mapper_.set_stage_observer([&](Stage stage) {
    const auto now = Clock::now();
    stages[static_cast<std::size_t>(stage)] += milliseconds(now - mark);
    mark = now;
  });
  finished->tracked = seen_from_body(track_with_prior(received), body_from_sensor_);
  mapper_.set_stage_observer(nullptr);
  finished->times.preprocess_ms = stages[0];
  finished->times.align_ms = stages[1];
  finished->times.map_ms = stages[2];
  if (!finished->tracked.map_fault.empty())
    statistics_.complain(&Counters::map_faults, finished->tracked.map_fault);
  if (const auto sentence = publishers_.look(finished->tracked))
    statistics_.complain(&Counters::two_publishers, *sentence);
}

TrackedScan Pipeline::track_with_prior(const ReceivedScan& received) {
  TrackedScan tracked = mapper_.track(received.scan, consistency_.prior(received.prior));
  const std::int64_t before = consistency_.contradictions();
  const auto sentence = consistency_.learn(received.prior, tracked);
  const std::int64_t contradictions = consistency_.contradictions() - before;
  if (sentence)
    statistics_.complain(&Counters::priors_contradicting, *sentence, contradictions);
  else
    statistics_.count(&Counters::priors_contradicting, contradictions);
  return tracked;
}

Pose Pipeline::correction(std::uint32_t stamp) const {
  const Pose in_sensor_map = mapper_.correction(stamp);
  if (in_sensor_map.matrix() == Pose::Identity().matrix()) return in_sensor_map;
  return body_from_sensor_ * in_sensor_map * body_from_sensor_.inverse();
}

void Pipeline::note_clock(const TrackedScan& tracked) {
  if (!tracked.clock_step_from) return;
  statistics_.complain(&Counters::clock_steps, "the clock of the scans stepped from utime " +
                                                   std::to_string(*tracked.clock_step_from) + " to " +
                                                   std::to_string(tracked.utime) +
                                                   "; map, pose and epoch are kept");
}

void Pipeline::execute(const Command& command) {
  const std::string what = std::string("command to ") + name_of(command.kind);
  try {
    attempt(command);
  } catch (const std::exception& error) {
    statistics_.complain(&Counters::commands_rejected, what + " rejected: " + error.what());
    return;
  }
  statistics_.say(LogLevel::kInfo, what + " executed");
  if (command.kind != CommandKind::kSaveMap)
    statistics_.count(&Counters::commands);  // a saved map is counted when it is written
}

void Pipeline::attempt(const Command& command) {
  const Pose& mount = body_from_sensor_;
  switch (command.kind) {
    case CommandKind::kSetPose:
      return mapper_.set_pose(mount.inverse() * command.map_from_body * mount);
    case CommandKind::kReset:
      return mapper_.reset();
    case CommandKind::kSaveMap:
      if (mode_ == Mode::kReplay)
        throw std::runtime_error("a replay does not execute recorded commands to save a map");
      return maps_.save_on_command(command.path, mapper_.save());
    case CommandKind::kLoadMap: {
      LoadedMap loaded = maps_.load(command.path);
      return mapper_.load(std::move(loaded.map), loaded.fixed);
    }
  }
}

void Pipeline::save_map_when_due() {
  if (maps_.is_due(Clock::now())) maps_.save_if_grown(mapper_.save());
}

PointCloud Pipeline::archived(float voxel, Part part) const {
  SavedMap map = mapper_.save();
  if (part == Part::kFirst) map = first_submap(std::move(map));
  return moved(cloud_of_map(map, voxel), body_from_sensor_);
}

void Pipeline::finish() {
  maps_.save_at_exit(mapper_.save());
}

}  // namespace scanlock
