// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/outputs.hpp"

#include <unistd.h>

#include "daemon/host_network.hpp"
#include "daemon/lcm_url.hpp"

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kRetry{1};

std::string host_name() {
  char name[256] = "";
  gethostname(name, sizeof name - 1);
  return name;
}

TwistFrame parse_twist_frame(const std::string& name) {
  return name == "body" ? TwistFrame::kBody : name == "zero" ? TwistFrame::kZero : TwistFrame::kLocal;
}

}  // namespace

Outputs::Outputs(const DaemonConfig& config, const std::string& version, Statistics& statistics)
    : config_(config),
      version_(version),
      host_(host_name()),
      url_(output_url(config)),
      replay_(is_log_url(input_url(config))),
      twist_frame_(parse_twist_frame(config.twist_frame)),
      statistics_(statistics) {
  if (is_log_url(url_)) {
    const std::string mode = url_option(url_, "mode").value_or("r");
    if (mode == "r")
      throw ConfigError(url_ + ": a log is written with ?mode=w (or mode=a to append) at its end");
    lcm_ = std::make_unique<lcm::LCM>(url_);
    if (!lcm_->good()) throw ConfigError(url_ + ": this log cannot be written; check its path");
  }
}

bool Outputs::connect() {
  if (lcm_) return true;
  const auto now = Clock::now();
  if (now < next_attempt_) return false;
  next_attempt_ = now + kRetry;
  std::string why = is_multicast_url(url_) ? multicast_fault(multicast_endpoint(url_)) : "";
  if (why.empty()) {
    auto lcm = std::make_unique<lcm::LCM>(url_);
    if (lcm->good()) {
      lcm_ = std::move(lcm);
      return true;
    }
    why = "LCM refused the URL; check it";
  }
  statistics_.set_error("cannot publish to " + url_ + ": " + why);
  if (failures_.allows(now)) log_line(LogLevel::kWarning, "cannot publish to " + url_ + ": " + why);
  return false;
}

void Outputs::send(const std::string& channel, const Bytes& message) {
  if (channel.empty()) return;
  if (connect() && lcm_->publish(channel, message.data(), static_cast<unsigned>(message.size())) == 0) return;
  statistics_.count(&Counters::publish_errors);
  if (!lcm_) return;  // connect() said why
  const std::string why = is_multicast_url(url_) ? multicast_fault(multicast_endpoint(url_)) : "";
  const std::string sentence = "publishing on " + channel + " failed" + (why.empty() ? "" : ": " + why);
  statistics_.set_error(sentence);
  if (failures_.allows(Clock::now())) log_line(LogLevel::kWarning, sentence);
}

OdometryContext Outputs::context_of(const FinishedScan& finished) {
  OdometryContext context;
  context.seq = seq_++;
  context.scan_seq = finished.scan_seq;
  context.frame_id = config_.map_frame;
  context.child_frame_id = config_.body_frame;
  if (replay_) return context;
  context.recv_utime = finished.recv_utime;
  context.pub_utime = utime_now();
  context.age_ms = static_cast<float>(static_cast<double>(context.pub_utime - finished.tracked.utime) / 1e3);
  context.times = finished.times;
  context.times.total_ms = std::chrono::duration<float, std::milli>(Clock::now() - finished.arrival).count();
  return context;
}

void Outputs::publish(const FinishedScan& finished) {
  const TrackedScan& tracked = finished.tracked;
  if (tracked.verdict != ScanVerdict::kTracked) {  // an empty scan still has a pose, the predicted one
    statistics_.count_verdict(tracked.verdict);
    statistics_.set_error("the scan of utime " + std::to_string(tracked.utime) +
                          " was not used: " + to_string(tracked.verdict));
    if (tracked.method != PoseMethod::kPredicted) return;
  }
  if (tracked.recovery) publish_recovery(*tracked.recovery, tracked.utime);
  publish_poses(tracked, context_of(finished));
  statistics_.count_published(
      std::chrono::duration<double, std::milli>(Clock::now() - finished.arrival).count());
  const bool changed = tracked.state != last_.state;
  if (changed) {
    log_line(tracked.state == TrackingState::kTracking ? LogLevel::kInfo : LogLevel::kWarning,
             std::string(to_string(tracked.state)) + " (was " + to_string(last_.state) + ") at utime " +
                 std::to_string(tracked.utime));
  }
  last_ = tracked;
  if (changed) publish_status();
}

void Outputs::publish_recovery(const Recovery& recovery, std::int64_t utime) {
  statistics_.count(recovery.accepted ? &Counters::recoveries : &Counters::recovery_failures);
  log_line(LogLevel::kInfo, std::string("search for the place at utime ") + std::to_string(utime) +
                                (recovery.accepted ? ", accepted: " : ", not accepted: ") + recovery.reason);
  send(config_.recovery_channel, encode_recovery(report_of(recovery, utime, recovery_seq_++, !replay_)));
}

void Outputs::publish_poses(const TrackedScan& tracked, const OdometryContext& context) {
  send(config_.odometry_channel, encode_odometry(tracked, context));
  if (tracked.method == PoseMethod::kPredicted && !config_.predicted_poses) return;
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
  status.utime = utime_now();
  status.uptime_us = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start_).count();
  status.version = version_;
  status.host = host_;
  status.state = last_.state;
  status.scans_received = counters.received;
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
  status.nonfinite_points = counters.nonfinite_points;
  status.kernel_drops = counters.kernel_drops;
  status.publish_errors = counters.publish_errors;
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
  status.rss_mb = static_cast<float>(resident_memory_mb());
  status.last_error_utime = counters.last_error_utime;
  status.last_error = counters.last_error;
  send(config_.status_channel, encode_status(status));
}

}  // namespace scanlock
