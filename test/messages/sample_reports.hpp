// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "messages/reports.hpp"

namespace scanlock {

/// Each member has a different value, so that a swap of two is found.
inline TrackedScan sample_tracked() {
  TrackedScan tracked;
  tracked.utime = 1700000000123456;
  tracked.state = TrackingState::kDegraded;
  tracked.method = PoseMethod::kIcp;
  tracked.stop_reason = StopReason::kIterations;
  tracked.map_from_body =
      Eigen::Translation3d(1.5, -20.25, 3) * Eigen::AngleAxisd(2.9, Eigen::Vector3d(1, -2, 3).normalized());
  tracked.twist << 1, 2, 3, 0.1, 0.2, 0.3;
  for (int i = 0; i < 36; ++i) tracked.covariance(i / 6, i % 6) = 0.5 * i;
  tracked.degenerate_axes = 0x21;
  tracked.epoch = 4;
  tracked.iterations = 11;
  tracked.points_in = 12;
  tracked.points_used = 13;
  tracked.inliers = 14;
  tracked.energy = 0.15;
  tracked.energy_baseline = 0.16;
  tracked.energy_score = 17.5;
  tracked.keyframes = 18;
  tracked.map_points = 19;
  return tracked;
}

inline OdometryContext sample_context() {
  return {1, 2, 3, 4, "map", "lidar", 5.5f, {6.5f, 7.5f, 8.5f, 9.5f, 10.5f, 11.5f}};
}

inline StatusReport sample_status() {
  StatusReport report;
  report.version = "0.1.0";
  report.host = "robot";
  report.state = TrackingState::kLost;
  std::int64_t next = 100;
  for (std::int64_t* counter : {&report.utime,
                                &report.uptime_us,
                                &report.scans_received,
                                &report.sectors_received,
                                &report.sectors_discarded,
                                &report.scans_used,
                                &report.scans_replaced,
                                &report.scans_incomplete,
                                &report.rejected_truncated,
                                &report.rejected_unknown_type,
                                &report.rejected_bad_size,
                                &report.rejected_bad_field,
                                &report.rejected_empty,
                                &report.rejected_duplicate_time,
                                &report.rejected_backward_time,
                                &report.rejected_clock,
                                &report.clock_steps,
                                &report.scans_without_time,
                                &report.nonfinite_points,
                                &report.kernel_drops,
                                &report.publish_errors,
                                &report.commands,
                                &report.commands_rejected,
                                &report.recoveries,
                                &report.recovery_failures,
                                &report.last_error_utime})
    *counter = next++;
  std::int32_t small = 1000;
  for (std::int32_t* value : {&report.recv_buf_wanted, &report.recv_buf_granted, &report.keyframes,
                              &report.map_points, &report.epoch})
    *value = small++;
  float fraction = 0.5f;
  for (float* value : {&report.input_hz, &report.output_hz, &report.latency_p50_ms, &report.latency_p95_ms,
                       &report.latency_p99_ms, &report.rss_mb})
    *value = fraction++;
  report.last_error = "LIDAR: the message ends within `data`";
  return report;
}

inline RecoveryReport sample_recovery() {
  RecoveryReport report;
  report.utime = 1;
  report.seq = 2;
  report.epoch = 3;
  report.map_from_body = sample_tracked().map_from_body;
  report.correction = sample_tracked().map_from_body.inverse();
  report.energy_before = 0.9;
  report.energy_after = 0.1;
  report.matches = 400;
  report.matches_kept = 300;
  report.consensus = 200;
  report.upper_bound = 201.5;
  report.runner_up_consensus = 50;
  report.certified = true;
  report.accepted = false;
  report.reason = "two places are alike";
  report.nodes = 12345678901;
  report.search_ms = 1.5f;
  report.total_ms = 2.5f;
  return report;
}

}  // namespace scanlock
