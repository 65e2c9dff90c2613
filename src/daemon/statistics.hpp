// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "daemon/log.hpp"
#include "messages/decode_scan.hpp"
#include "odometry/tracker.hpp"

namespace scanlock {

/// The current time in microseconds since the epoch, as in LCM stamps.
std::int64_t utime_now();

/// All counters, from the start of the daemon.
struct Counters {
  std::int64_t received = 0;  ///< scans, whole or joined, and messages on their channels that hold none
  std::int64_t sectors = 0, sectors_discarded = 0;  ///< sectors that arrived; of those, discarded ones
  std::int64_t used = 0;                            ///< tracked; a pose was published
  std::int64_t replaced = 0;                        ///< a newer scan arrived before the worker was free
  std::int64_t incomplete = 0;                      ///< joined from sectors of which some were lost
  std::int64_t truncated = 0, unknown_type = 0, bad_size = 0, bad_field = 0;
  std::int64_t empty = 0, duplicate_time = 0, backward_time = 0;
  std::int64_t clock = 0;                ///< rejected: stamped by another clock than the scans around them
  std::int64_t clock_steps = 0;          ///< steps of the scans' clock
  std::int64_t two_publishers = 0;       ///< scans or messages that indicate two publishers
  std::int64_t map_faults = 0;           ///< failures to read points of the map
  std::int64_t without_time = 0;         ///< utime was not positive; the time of arrival was used
  std::int64_t without_point_times = 0;  ///< scans with points, but without times of the points
  std::int64_t nonfinite_points = 0;
  std::int64_t kernel_drops = 0;
  std::int64_t publish_errors = 0;
  std::int64_t priors_rejected = 0;       ///< messages of other sensors: undecodable, not finite, backward
  std::int64_t priors_absent = 0;         ///< scans for which a configured sensor had no measurement
  std::int64_t priors_contradicting = 0;  ///< scans that contradict the measurement of another sensor
  std::int64_t commands = 0, commands_rejected = 0;
  std::int64_t recoveries = 0, recovery_failures = 0;  ///< global registrations, accepted and not accepted
  std::int64_t last_error_utime = 0;
  std::string last_error;

  std::int64_t rejected() const {
    return truncated + unknown_type + bad_size + bad_field + empty + duplicate_time + backward_time + clock;
  }
};

struct Latency {
  double p50_ms = 0, p95_ms = 0, p99_ms = 0;
};

/// The rate of events over the last 5 seconds; holds at most kMax events.
class RateMeter {
 public:
  void add(std::chrono::steady_clock::time_point now);
  double per_second(std::chrono::steady_clock::time_point now) const;

 private:
  static constexpr std::size_t kMax = 4096;
  std::deque<std::chrono::steady_clock::time_point> events_;
};

/// Counters and log of the daemon; shared by its threads.
class Statistics {
 public:
  struct Report {
    Counters counters;
    Latency latency;  ///< from arrival to publishing, over the last 1000 scans
    double input_hz = 0, output_hz = 0;
    int recv_buf_wanted = 0, recv_buf_granted = 0;
  };

  explicit Statistics(LogFunction log = log_line) : log_(std::move(log)) {}

  /// In a replay: sets the time of the current event. From then on no part of a report depends on this
  /// machine or its clock.
  void set_replay_time(std::int64_t utime);

  void count(std::int64_t Counters::*counter, std::int64_t number = 1);
  /// Counts, makes the sentence the last error, and logs it, at most once in ten seconds per counter.
  void complain(std::int64_t Counters::*counter, const std::string& sentence, std::int64_t number = 1);
  /// As above without a counter; logs every sentence.
  void complain(const std::string& sentence);
  /// Logs a line that is not an error.
  void say(LogLevel level, const std::string& sentence) const { log_(level, sentence); }

  void count_received();
  void count_fault(DecodeFault fault, const std::string& sentence);
  void count_verdict(const TrackedScan& tracked);
  void count_published(double latency_ms);
  void set_error(const std::string& sentence);
  void set_receive_buffer(int wanted, int granted);

  Report report() const;
  /// The first sentence of the complaints with this counter; empty when there was none.
  std::string first_complaint(std::int64_t Counters::*counter) const;

 private:
  struct Complaint {
    std::int64_t Counters::*counter;
    std::string first;
    Throttle throttle;
  };
  Complaint& complaint_of(std::int64_t Counters::*counter);
  void set_error_locked(const std::string& sentence);

  const LogFunction log_;
  mutable std::mutex mutex_;
  Report report_;
  std::optional<std::int64_t> replay_utime_;
  std::vector<Complaint> complaints_;
  RateMeter input_, output_;
  std::vector<double> latencies_ms_;  ///< the last 1000, as a ring buffer
  std::size_t next_latency_ = 0;
};

/// Nearest-rank percentile: the smallest element v for which at least `fraction` of `values` are <= v; 0 when
/// `values` is empty.
double percentile(std::vector<double> values, double fraction);

/// Resident memory of this process in MB (1e6 bytes).
double resident_memory_mb();

}  // namespace scanlock
