// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/outputs.hpp"

#include <unistd.h>

#include <algorithm>

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;

std::string host_name() {
  char name[256] = "";
  gethostname(name, sizeof name - 1);
  return name;
}

TrackedScan with_pose(TrackedScan tracked, const Pose& pose) {
  tracked.map_from_body = pose;
  return tracked;
}

TwistFrame parse_twist_frame(const std::string& name) {
  return name == "body" ? TwistFrame::kBody : name == "zero" ? TwistFrame::kZero : TwistFrame::kLocal;
}

}  // namespace

Outputs::Outputs(const DaemonConfig& config, const std::string& version, Statistics& statistics,
                 MessageSink& sink, Pipeline::Mode mode)
    : config_(config),
      version_(version),
      host_(mode == Pipeline::Mode::kReplay ? "" : host_name()),
      twist_frame_(parse_twist_frame(config.twist_frame)),
      mode_(mode),
      statistics_(statistics),
      sink_(sink) {}

void Outputs::send(const std::string& channel, const Bytes& message) {
  if (!channel.empty()) sink_.send(utime_, channel, message);
}

OdometryContext Outputs::context_of(const FinishedScan& finished) {
  OdometryContext context;
  context.seq = seq_++;
  context.scan_seq = finished.scan_seq;
  context.frame_id = config_.map_frame;
  context.child_frame_id = config_.body_frame;
  if (replay()) return context;
  context.recv_utime = finished.recv_utime;
  context.pub_utime = utime_now();
  context.age_ms = static_cast<float>(static_cast<double>(context.pub_utime - finished.tracked.utime) / 1e3);
  context.times = finished.times;
  context.times.total_ms = std::chrono::duration<float, std::milli>(Clock::now() - finished.arrival).count();
  return context;
}

void Outputs::publish(const FinishedScan& finished) {
  const TrackedScan& tracked = finished.tracked;
  statistics_.count_verdict(tracked);
  if (tracked.method == PoseMethod::kNone && tracked.verdict != ScanVerdict::kTracked) return;
  utime_ = replay() ? tracked.utime : utime_now();
  if (first_utime_ == 0) first_utime_ = tracked.utime;
  if (tracked.recovery) publish_recovery(*tracked.recovery, tracked.utime);
  publish_poses(tracked, context_of(finished));
  if (tracked.verdict == ScanVerdict::kTracked)
    statistics_.count_published(
        std::chrono::duration<double, std::milli>(Clock::now() - finished.arrival).count());
  const bool changed = tracked.state != last_.state;
  if (changed) say_state(tracked);
  last_ = tracked;
  if (changed || status_is_due(tracked.utime)) publish_status();
}

void Outputs::say_state(const TrackedScan& tracked) const {
  statistics_.say(tracked.state == TrackingState::kTracking ? LogLevel::kInfo : LogLevel::kWarning,
                  std::string(to_string(tracked.state)) + " (was " + to_string(last_.state) + ") at utime " +
                      std::to_string(tracked.utime) +
                      (tracked.localised ? "" : "; not yet relocalised in the loaded map"));
}

bool Outputs::status_is_due(std::int64_t utime) const {
  const auto period = static_cast<std::int64_t>(1e6 * config_.status_period_s);
  return replay() && (status_utime_ == 0 || utime - status_utime_ >= period || utime < status_utime_);
}

void Outputs::publish_recovery(const Recovery& recovery, std::int64_t utime) {
  if (recovery.loop_closure) {
    statistics_.say(LogLevel::kInfo, "loop closure at utime " + std::to_string(utime));
  } else {
    statistics_.count(recovery.accepted ? &Counters::recoveries : &Counters::recovery_failures);
    statistics_.say(LogLevel::kInfo, std::string("relocalisation search at utime ") + std::to_string(utime) +
                                         (recovery.accepted ? ", accepted: " : ", not accepted: ") +
                                         recovery.reason);
  }
  send(config_.recovery_channel, encode_recovery(report_of(recovery, utime, recovery_seq_++, !replay())));
}

void Outputs::publish_poses(const TrackedScan& tracked, const OdometryContext& context) {
  send(config_.odometry_channel, encode_odometry(tracked, context));
  // The messages below cannot mark a pose as predicted.
  if (tracked.method == PoseMethod::kPredicted && !config_.predicted_poses) return;
  send(config_.local_pose_channel, encode_pose(with_pose(tracked, tracked.local_from_body), twist_frame_));
  if (!tracked.localised) return;  // no pose in a loaded map is known before a hypothesis is accepted
  if (!config_.local_to_map_channel.empty()) {
    const Pose map_from_local = tracked.map_from_body * tracked.local_from_body.inverse();
    send(config_.local_to_map_channel, encode_rigid_transform(with_pose(tracked, map_from_local)));
  }
  send(config_.pose_channel, encode_pose(tracked, twist_frame_));
  if (!config_.rigid_transform_channel.empty())
    send(config_.rigid_transform_channel, encode_rigid_transform(tracked));
  if (!config_.pose2d_channel.empty()) send(config_.pose2d_channel, encode_pose2d(tracked));
  if (!config_.nav_odometry_channel.empty()) {
    send(config_.nav_odometry_channel, encode_nav_odometry(tracked, config_.map_frame, config_.body_frame,
                                                           static_cast<std::int32_t>(context.seq)));
  }
}

void Outputs::publish_status() {
  const Statistics::Report report = statistics_.report();
  const Counters& counters = report.counters;
  StatusReport status;
  utime_ = replay() ? last_.utime : utime_now();
  status_utime_ = last_.utime;
  status.utime = utime_;
  status.uptime_us =
      replay() ? std::max<std::int64_t>(last_.utime - first_utime_, 0)
               : std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start_).count();
  status.version = version_;
  status.host = host_;
  status.state = last_.state;
  status.scans_received = counters.received;
  status.sectors_received = counters.sectors;
  status.sectors_discarded = counters.sectors_discarded;
  status.scans_used = counters.used;
  status.scans_replaced = counters.replaced;
  status.scans_incomplete = counters.incomplete;
  status.rejected_truncated = counters.truncated;
  status.rejected_unknown_type = counters.unknown_type;
  status.rejected_bad_size = counters.bad_size;
  status.rejected_bad_field = counters.bad_field;
  status.rejected_empty = counters.empty;
  status.rejected_duplicate_time = counters.duplicate_time;
  status.rejected_backward_time = counters.backward_time;
  status.rejected_clock = counters.clock;
  status.clock_steps = counters.clock_steps;
  status.scans_without_time = counters.without_time;
  status.nonfinite_points = counters.nonfinite_points;
  status.kernel_drops = counters.kernel_drops;
  status.publish_errors = counters.publish_errors;
  status.commands = counters.commands;
  status.commands_rejected = counters.commands_rejected;
  status.recoveries = counters.recoveries;
  status.recovery_failures = counters.recovery_failures;
  status.recv_buf_wanted = report.recv_buf_wanted;
  status.recv_buf_granted = report.recv_buf_granted;
  status.keyframes = last_.keyframes;
  status.map_points = last_.map_points;
  status.epoch = static_cast<std::int32_t>(last_.epoch);
  status.input_hz = static_cast<float>(report.input_hz);
  status.output_hz = static_cast<float>(report.output_hz);
  status.latency_p50_ms = static_cast<float>(report.latency.p50_ms);
  status.latency_p95_ms = static_cast<float>(report.latency.p95_ms);
  status.latency_p99_ms = static_cast<float>(report.latency.p99_ms);
  if (!replay()) status.rss_mb = static_cast<float>(resident_memory_mb());
  status.last_error_utime = counters.last_error_utime;
  status.last_error = counters.last_error;
  send(config_.status_channel, encode_status(status));
}

}  // namespace scanlock
