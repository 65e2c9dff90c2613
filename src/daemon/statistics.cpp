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
constexpr std::chrono::seconds kComplaintPeriod{10};  // hundreds per second would hide all other lines

bool is_rejection(std::int64_t Counters::*counter) {
  Counters one;
  one.*counter = 1;
  return one.rejected() == 1;
}

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

void Statistics::set_replay_time(std::int64_t utime) {
  const std::lock_guard<std::mutex> lock(mutex_);
  replay_utime_ = utime;
}

void Statistics::count(std::int64_t Counters::*counter, std::int64_t number) {
  const std::lock_guard<std::mutex> lock(mutex_);
  report_.counters.*counter += number;
}

Statistics::Complaint& Statistics::complaint_of(std::int64_t Counters::*counter) {
  const auto known = std::find_if(complaints_.begin(), complaints_.end(),
                                  [&](const Complaint& complaint) { return complaint.counter == counter; });
  if (known != complaints_.end()) return *known;
  complaints_.push_back({counter, "", Throttle(kComplaintPeriod)});
  return complaints_.back();
}

void Statistics::complain(std::int64_t Counters::*counter, const std::string& sentence, std::int64_t number) {
  std::string line;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    report_.counters.*counter += number;
    Complaint& complaint = complaint_of(counter);
    if (complaint.first.empty()) complaint.first = sentence;
    set_error_locked(sentence);
    if (!complaint.throttle.allows(Clock::now())) return;
    line = (is_rejection(counter) ? "rejected: " : "") + sentence;
    const long more = complaint.throttle.suppressed();
    if (more > 0) line += " (and " + std::to_string(more) + " like it before)";
  }
  log_(LogLevel::kWarning, line);
}

void Statistics::complain(const std::string& sentence) {
  set_error(sentence);
  log_(LogLevel::kWarning, sentence);
}

std::string Statistics::first_complaint(std::int64_t Counters::*counter) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const Complaint& complaint : complaints_) {
    if (complaint.counter == counter) return complaint.first;
  }
  return "";
}

void Statistics::count_received() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++report_.counters.received;
  input_.add(Clock::now());
}

void Statistics::count_fault(DecodeFault fault, const std::string& sentence) {
  switch (fault) {
    case DecodeFault::kNone:
      return;
    case DecodeFault::kTruncated:
      return complain(&Counters::truncated, sentence);
    case DecodeFault::kUnknownType:
      return complain(&Counters::unknown_type, sentence);
    case DecodeFault::kBadSize:
      return complain(&Counters::bad_size, sentence);
    case DecodeFault::kBadField:
      return complain(&Counters::bad_field, sentence);
  }
}

void Statistics::count_verdict(const TrackedScan& tracked) {
  const std::string scan = "the scan of utime " + std::to_string(tracked.utime) + " was not used: ";
  switch (tracked.verdict) {
    case ScanVerdict::kTracked:
      return;  // counted in count_published()
    case ScanVerdict::kEmpty:
      return complain(&Counters::empty, scan + tracked.why);
    case ScanVerdict::kDuplicateTime:
      return complain(&Counters::duplicate_time, scan + tracked.why);
    case ScanVerdict::kBackwardTime:
      return complain(&Counters::backward_time, scan + tracked.why);
    case ScanVerdict::kOtherClock:
      return complain(&Counters::clock, scan + tracked.why);
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

void Statistics::set_error(const std::string& sentence) {
  const std::lock_guard<std::mutex> lock(mutex_);
  set_error_locked(sentence);
}

void Statistics::set_error_locked(const std::string& sentence) {
  report_.counters.last_error_utime = replay_utime_ ? *replay_utime_ : utime_now();
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
  if (replay_utime_) return report;
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
