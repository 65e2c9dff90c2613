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

/// Microseconds since the epoch, as LCM stamps.
std::int64_t utime_now();

/// All that is counted, since the start.
struct Counters {
  std::int64_t received = 0;  ///< scans, whole or joined, and messages on their channels that hold none
  std::int64_t sectors = 0, sectors_discarded = 0;  ///< slices that came; those of no use: late or repeated
  std::int64_t used = 0;                            ///< tracked; a pose was published
  std::int64_t replaced = 0;                        ///< a fresher scan came before the worker was free
  std::int64_t incomplete = 0;                      ///< put together from sectors of which some were lost
  std::int64_t truncated = 0, unknown_type = 0, bad_size = 0, bad_field = 0;
  std::int64_t empty = 0, duplicate_time = 0, backward_time = 0;
  std::int64_t clock = 0;           ///< stamped by another clock than the scans around them, and rejected
  std::int64_t clock_steps = 0;     ///< times the clock of the scans stepped
  std::int64_t two_publishers = 0;  ///< scans or messages that told of two publishers
  std::int64_t map_faults = 0;      ///< times that points of the map could not be read
  std::int64_t without_time = 0;    ///< utime was not positive; the time of arrival was taken
  std::int64_t without_point_times = 0;  ///< scans with points, but no times of them
  std::int64_t nonfinite_points = 0;
  std::int64_t kernel_drops = 0;
  std::int64_t publish_errors = 0;
  std::int64_t priors_rejected = 0;       ///< messages of other sensors: undecodable, not finite, backward
  std::int64_t priors_absent = 0;         ///< scans of whose instant a configured sensor said nothing
  std::int64_t priors_contradicting = 0;  ///< scans that contradict what it said
  std::int64_t commands = 0, commands_rejected = 0;
  std::int64_t recoveries = 0, recovery_failures = 0;  ///< global registrations, accepted and not
  std::int64_t last_error_utime = 0;
  std::string last_error;

  std::int64_t rejected() const {
    return truncated + unknown_type + bad_size + bad_field + empty + duplicate_time + backward_time + clock;
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

/// What happened, counted and in words; shared by the threads of a daemon.
class Statistics {
 public:
  struct Report {
    Counters counters;
    Latency latency;  ///< from arrival to publishing, over the last scans
    double input_hz = 0, output_hz = 0;
    int recv_buf_wanted = 0, recv_buf_granted = 0;
  };

  explicit Statistics(LogFunction log = log_line) : log_(std::move(log)) {}

  /// In a replay: the time of the event at hand. From then on nothing that is reported depends on this
  /// machine or its clock.
  void set_replay_time(std::int64_t utime);

  void count(std::int64_t Counters::*counter, std::int64_t number = 1);
  /// Counts, makes the sentence the last error, and logs it: of each counter once in ten seconds.
  void complain(std::int64_t Counters::*counter, const std::string& sentence, std::int64_t number = 1);
  /// The same without a counter, each time.
  void complain(const std::string& sentence);
  /// A line for the log that is no error.
  void say(LogLevel level, const std::string& sentence) const { log_(level, sentence); }

  void count_received();
  void count_fault(DecodeFault fault, const std::string& sentence);
  void count_verdict(const TrackedScan& tracked);
  void count_published(double latency_ms);
  void set_error(const std::string& sentence);
  void set_receive_buffer(int wanted, int granted);

  Report report() const;
  /// The first sentence that a counter was complained of with; empty for none.
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
  std::vector<double> latencies_ms_;  ///< the last ones, as a ring
  std::size_t next_latency_ = 0;
};

/// The value that `fraction` of `values` do not exceed; 0 for none.
double percentile(std::vector<double> values, double fraction);

/// Resident memory of this process in MB (1e6 bytes).
double resident_memory_mb();

}  // namespace scanlock
