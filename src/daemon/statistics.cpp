// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/statistics.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace scanlock {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kRateWindow{5};
constexpr std::size_t kLatencies = 1000;
constexpr std::size_t kMaxErrorLength = 400;

}  // namespace

std::int64_t utime_now() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(since_epoch).count();
}

void RateMeter::add(Clock::time_point now) {
  events_.push_back(now);
  while (events_.size() > kMax || (!events_.empty() && now - events_.front() > kRateWindow))
    events_.pop_front();
}

double RateMeter::per_second(Clock::time_point now) const {
  const auto first = std::find_if(events_.begin(), events_.end(),
                                  [&](Clock::time_point event) { return now - event <= kRateWindow; });
  const auto intervals = std::distance(first, events_.end()) - 1;
  if (intervals < 1) return 0;
  return static_cast<double>(intervals) /
         std::chrono::duration<double>(std::max(events_.back() - *first, Clock::duration(1))).count();
}

void Statistics::count_received(std::size_t bytes) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++report_.counters.received;
  report_.largest_message = std::max(report_.largest_message, bytes);
  input_.add(Clock::now());
}

void Statistics::count_fault(DecodeFault fault, const std::string& sentence) {
  switch (fault) {
    case DecodeFault::kNone:
      return;
    case DecodeFault::kTruncated:
      count(&Counters::truncated);
      break;
    case DecodeFault::kUnknownType:
      count(&Counters::unknown_type);
      break;
    case DecodeFault::kBadSize:
      count(&Counters::bad_size);
      break;
    case DecodeFault::kBadField:
      count(&Counters::bad_field);
      break;
  }
  set_error(sentence);
}

void Statistics::count_verdict(ScanVerdict verdict) {
  switch (verdict) {
    case ScanVerdict::kTracked:
      return;  // counted when its pose is published
    case ScanVerdict::kEmpty:
      return count(&Counters::empty);
    case ScanVerdict::kDuplicateTime:
      return count(&Counters::duplicate_time);
    case ScanVerdict::kBackwardTime:
      return count(&Counters::backward_time);
  }
}

void Statistics::count_published(double latency_ms) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++report_.counters.used;
  output_.add(Clock::now());
  if (latencies_ms_.size() < kLatencies) {
    latencies_ms_.push_back(latency_ms);
  } else {
    latencies_ms_[next_latency_] = latency_ms;
    next_latency_ = (next_latency_ + 1) % kLatencies;
  }
}

void Statistics::count(std::int64_t Counters::*counter, std::int64_t number) {
  const std::lock_guard<std::mutex> lock(mutex_);
  report_.counters.*counter += number;
}

void Statistics::set_error(const std::string& sentence) {
  const std::lock_guard<std::mutex> lock(mutex_);
  report_.counters.last_error_utime = utime_now();
  report_.counters.last_error = sentence.substr(0, kMaxErrorLength);
}

void Statistics::set_receive_buffer(int wanted, int granted) {
  const std::lock_guard<std::mutex> lock(mutex_);
  report_.recv_buf_wanted = wanted;
  report_.recv_buf_granted = granted;
}

Statistics::Report Statistics::report() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  Report report = report_;
  report.latency = {percentile(latencies_ms_, 0.5), percentile(latencies_ms_, 0.95),
                    percentile(latencies_ms_, 0.99)};
  report.input_hz = input_.per_second(Clock::now());
  report.output_hz = output_.per_second(Clock::now());
  return report;
}

double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  const double rank = std::ceil(fraction * static_cast<double>(values.size())) - 1;
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 0.0));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

double resident_memory_mb() {
  std::ifstream file("/proc/self/statm");
  double total_pages = 0, resident_pages = 0;
  file >> total_pages >> resident_pages;
  return resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace scanlock
