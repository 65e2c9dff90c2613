// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "geometry/rigid.hpp"
#include "odometry/tracker.hpp"

namespace scanlock {

/// Milliseconds spent in each stage on one scan; all zero in a replay, so that its output does not depend on
/// the machine.
struct StageTimes {
  float decode_ms = 0;  ///< checking and unpacking the message
  float wait_ms = 0;    ///< from the end of decoding until the worker took the scan
  float preprocess_ms = 0;
  float align_ms = 0;
  float map_ms = 0;
  float total_ms = 0;  ///< from arrival to publishing
};

/// The members of scanlock.odometry_t that are not in TrackedScan.
struct OdometryContext {
  std::int64_t recv_utime = 0;  ///< microseconds, arrival of the scan
  std::int64_t pub_utime = 0;   ///< microseconds, publishing of the message
  std::int64_t seq = 0;         ///< counts the messages of this type
  std::int32_t scan_seq = 0;
  std::string frame_id = "map";
  std::string child_frame_id = "body";
  float age_ms = 0;  ///< from the stamp of the scan to publishing
  StageTimes times;
};

/// A decoded scanlock.odometry_t.
struct OdometryReport {
  TrackedScan tracked;
  OdometryContext context;
};

/// The contents of scanlock.status_t; lcmtypes/status_t.lcm explains each member. Counters count from the
/// start.
struct StatusReport {
  std::int64_t utime = 0;
  std::int64_t uptime_us = 0;
  std::string version;
  std::string host;
  TrackingState state = TrackingState::kInitialising;

  std::int64_t scans_received = 0;
  std::int64_t sectors_received = 0;
  std::int64_t sectors_discarded = 0;
  std::int64_t scans_used = 0;
  std::int64_t scans_replaced = 0;
  std::int64_t scans_incomplete = 0;
  std::int64_t rejected_truncated = 0;
  std::int64_t rejected_unknown_type = 0;
  std::int64_t rejected_bad_size = 0;
  std::int64_t rejected_bad_field = 0;
  std::int64_t rejected_empty = 0;
  std::int64_t rejected_duplicate_time = 0;
  std::int64_t rejected_backward_time = 0;
  std::int64_t rejected_clock = 0;
  std::int64_t clock_steps = 0;
  std::int64_t scans_without_time = 0;
  std::int64_t nonfinite_points = 0;
  std::int64_t kernel_drops = 0;
  std::int64_t publish_errors = 0;
  std::int64_t commands = 0;
  std::int64_t commands_rejected = 0;
  std::int64_t recoveries = 0;
  std::int64_t recovery_failures = 0;

  std::int32_t recv_buf_wanted = 0;
  std::int32_t recv_buf_granted = 0;
  std::int32_t keyframes = 0;
  std::int32_t map_points = 0;
  std::int32_t epoch = 0;
  float input_hz = 0;
  float output_hz = 0;
  float latency_p50_ms = 0;
  float latency_p95_ms = 0;
  float latency_p99_ms = 0;
  float rss_mb = 0;
  std::int64_t last_error_utime = 0;
  std::string last_error;
};

/// The contents of scanlock.recovery_t; lcmtypes/recovery_t.lcm explains each member.
struct RecoveryReport {
  std::int64_t utime = 0;
  std::int64_t seq = 0;
  std::int32_t epoch = 0;
  Pose map_from_body = Pose::Identity();
  Pose correction = Pose::Identity();  ///< corrected pose = correction * predicted pose
  double energy_before = 0;
  double energy_after = 0;
  std::int32_t matches = 0;
  std::int32_t matches_kept = 0;
  std::int32_t consensus = 0;
  double upper_bound = 0;
  std::int32_t runner_up_consensus = 0;
  bool certified = false;
  bool accepted = false;
  std::string reason;
  std::int64_t nodes = 0;
  float search_ms = 0;
  float total_ms = 0;
};

/// The report of a Recovery, that is of an attempt at relocalisation or a loop closure, which ended with this
/// scan. `seq` counts the reports. Without `times`, the content does not depend on the machine.
RecoveryReport report_of(const Recovery& recovery, std::int64_t utime, std::int64_t seq, bool times);

/// The contents of scanlock.command_t. The numbers are part of the message definition.
enum class CommandKind : std::int8_t { kSetPose = 1, kReset = 2, kSaveMap = 3, kLoadMap = 4 };
struct Command {
  std::int64_t utime = 0;
  CommandKind kind = CommandKind::kReset;
  Pose map_from_body = Pose::Identity();  ///< for kSetPose
  std::string path;                       ///< for kSaveMap and kLoadMap
};

}  // namespace scanlock
