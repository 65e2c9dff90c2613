// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <vector>

#include "messages/decode_scan.hpp"
#include "odometry/tracker.hpp"

namespace scanlock {

/// Microseconds since the epoch, as LCM stamps.
std::int64_t utime_now();

/// All that is counted, since the start.
struct Counters {
  std::int64_t received = 0;    ///< messages on the scan channels
  std::int64_t used = 0;        ///< tracked; a pose was published
  std::int64_t replaced = 0;    ///< a fresher scan came before the worker was free
  std::int64_t incomplete = 0;  ///< put together from sectors of which some were lost
  std::int64_t truncated = 0, unknown_type = 0, bad_size = 0, bad_field = 0;
  std::int64_t empty = 0, duplicate_time = 0, backward_time = 0;
  std::int64_t without_time = 0;  ///< utime was not positive; the time of arrival was taken
  std::int64_t nonfinite_points = 0;
  std::int64_t kernel_drops = 0;
  std::int64_t publish_errors = 0;
  std::int64_t recoveries = 0, recovery_failures = 0;  ///< global registrations, accepted and not
  std::int64_t last_error_utime = 0;
  std::string last_error;

  std::int64_t rejected() const {
    return truncated + unknown_type + bad_size + bad_field + empty + duplicate_time + backward_time;
  }
};

struct Latency {
  double p50_ms = 0, p95_ms = 0, p99_ms = 0;
};

/// What happened in `window` before now, as a rate; holds `kMax` events at most.
class RateMeter {
 public:
  void add(std::chrono::steady_clock::time_point now);
  double per_second(std::chrono::steady_clock::time_point now) const;

 private:
  static constexpr std::size_t kMax = 4096;
  std::deque<std::chrono::steady_clock::time_point> events_;
};

/// The daemon's memory of itself, shared by its threads.
class Statistics {
 public:
  struct Report {
    Counters counters;
    Latency latency;  ///< from arrival to publishing, over the last scans
    double input_hz = 0, output_hz = 0;
    int recv_buf_wanted = 0, recv_buf_granted = 0;
    std::size_t largest_message = 0;  ///< bytes
  };

  void count_received(std::size_t bytes);
  void count_fault(DecodeFault fault, const std::string& sentence);
  void count_verdict(ScanVerdict verdict);
  void count_published(double latency_ms);
  void count(std::int64_t Counters::*counter, std::int64_t number = 1);
  void set_error(const std::string& sentence);
  void set_receive_buffer(int wanted, int granted);
  Report report() const;

 private:
  mutable std::mutex mutex_;
  Report report_;
  RateMeter input_, output_;
  std::vector<double> latencies_ms_;  ///< the last ones, as a ring
  std::size_t next_latency_ = 0;
};

/// The value that `fraction` of `values` do not exceed; 0 for none.
double percentile(std::vector<double> values, double fraction);

/// Resident memory of this process in MB (1e6 bytes).
double resident_memory_mb();

}  // namespace scanlock
