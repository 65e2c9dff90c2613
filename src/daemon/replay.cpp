// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/replay.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <utility>

#include "daemon/mount.hpp"
#include "io/cloud_file.hpp"
#include "io/lcm_log.hpp"
#include "messages/decode_scan.hpp"
#include "messages/encode.hpp"
#include "messages/sector_assembler.hpp"

namespace scanlock {
namespace {

TwistFrame twist_frame(const std::string& name) {
  return name == "body" ? TwistFrame::kBody : name == "zero" ? TwistFrame::kZero : TwistFrame::kLocal;
}

/// The pipeline of one replay: what each scan leads to, and what is written of it.
class Replay {
 public:
  Replay(const ReplayOptions& options, const Config& config)
      : config_(config), tracker_(config.tracker), mount_(body_from_sensor(config.daemon.mount)) {
    if (!options.output_log_path.empty()) writer_.emplace(options.output_log_path);
  }

  void take(const DecodedScan& decoded) {
    if (decoded.fault != DecodeFault::kNone) {
      if (result_.rejected++ == 0) result_.first_error = decoded.error;
      return;
    }
    ++result_.scans;
    const TrackedScan tracked = seen_from_body(tracker_.track(decoded.scan), mount_);
    if (const auto request = tracker_.take_request()) tracker_.give(finder_.find(*request));
    if (tracked.verdict == ScanVerdict::kDuplicateTime || tracked.verdict == ScanVerdict::kBackwardTime) {
      ++result_.bad_times;
      return;
    }
    if (tracked.verdict == ScanVerdict::kEmpty && tracked.method == PoseMethod::kNone)
      return;  // before the first
    record(tracked);
  }

  void count_fault(const std::string& sentence) {
    if (result_.rejected++ == 0) result_.first_error = sentence;
  }

  ReplayResult finish(const ReplayOptions& options) {
    if (writer_) writer_->close();
    if (!options.map_path.empty()) write_cloud(options.map_path, tracker_.map());
    return std::move(result_);
  }

  ReplayResult& result() { return result_; }

 private:
  void record(const TrackedScan& tracked) {
    ++result_.states[static_cast<std::size_t>(tracked.state)];
    const bool recovered = tracked.recovery && tracked.recovery->accepted;
    if (tracked.recovery) ++(recovered ? result_.recoveries : result_.recovery_failures);
    if (tracked.epoch != epoch_ && !recovered) ++result_.false_starts;
    if (!result_.trajectory.empty() && tracked.epoch == epoch_) {
      result_.distance_m +=
          (tracked.map_from_body.translation() - result_.trajectory.back().pose.translation()).norm();
    }
    epoch_ = tracked.epoch;
    result_.trajectory.push_back({static_cast<double>(tracked.utime) * 1e-6, tracked.map_from_body});
    if (!writer_) return;
    const DaemonConfig& daemon = config_.daemon;
    if (!daemon.pose_channel.empty()) {
      writer_->write(tracked.utime, daemon.pose_channel,
                     encode_pose(tracked, twist_frame(daemon.twist_frame)));
    }
    if (!daemon.recovery_channel.empty() && tracked.recovery) {
      writer_->write(
          tracked.utime, daemon.recovery_channel,
          encode_recovery(report_of(*tracked.recovery, tracked.utime, recovery_sequence_++, false)));
    }
    if (!daemon.odometry_channel.empty()) {
      OdometryContext context;  // no clock: the same bytes every time
      context.recv_utime = context.pub_utime = tracked.utime;
      context.seq = sequence_++;
      context.frame_id = daemon.map_frame;
      context.child_frame_id = daemon.body_frame;
      writer_->write(tracked.utime, daemon.odometry_channel, encode_odometry(tracked, context));
    }
  }

  const Config& config_;
  Tracker tracker_;
  PlaceFinder finder_;
  Pose mount_;
  std::optional<LogWriter> writer_;
  ReplayResult result_;
  std::uint32_t epoch_ = 0;
  std::int64_t sequence_ = 0, recovery_sequence_ = 0;
};

}  // namespace

ReplayResult replay_log(const ReplayOptions& options, const Config& config,
                        const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  using Clock = std::chrono::steady_clock;
  LogReader reader(options.log_path);
  Replay replay(options, config);
  DecodeLimits limits;
  limits.max_message_bytes = static_cast<std::size_t>(config.daemon.max_message_bytes);
  limits.max_points = static_cast<std::size_t>(config.daemon.max_points);
  limits.mbot_clockwise = config.daemon.mbot_clockwise;
  std::map<std::string, SectorAssembler> assemblers;
  for (const std::string& channel : config.daemon.scan_channels)
    assemblers.emplace(channel, limits.max_points);

  while (const std::optional<LogEvent> event = reader.next()) {
    const auto assembler = assemblers.find(event->channel);
    if (assembler == assemblers.end()) continue;
    const Clock::time_point begin = Clock::now();
    bool whole = false;
    for (const DecodedScan& scan :
         assembler->second.add(decode_scan(event->data.data(), event->data.size(), limits))) {
      replay.take(scan);
      whole = true;
    }
    if (whole) {
      replay.result().scan_ms.push_back(
          std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
    }
    if (progress) progress(reader.position(), reader.file_size());
  }
  for (auto& [channel, assembler] : assemblers) {
    if (const std::optional<DecodedScan> rest = assembler.flush()) replay.take(*rest);
  }
  if (reader.damaged_places() > 0 || reader.truncated()) {
    replay.result().damage = options.log_path + ": " + std::to_string(reader.damaged_places()) +
                             " damaged places, " + std::to_string(reader.skipped_bytes()) + " bytes skipped" +
                             (reader.truncated() ? ", the last event is cut short" : "");
  }
  return replay.finish(options);
}

}  // namespace scanlock
