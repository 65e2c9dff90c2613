// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/prior_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

namespace scanlock {
namespace {

constexpr std::size_t kMostSamples = 4096;
constexpr std::int64_t kMemory = 4000000;          // microseconds
constexpr std::int64_t kRestart = 1000000;         // microseconds back
constexpr std::int64_t kMostPause = 500000;        // microseconds between two samples
constexpr std::int64_t kMostAhead = 100000;        // microseconds of extrapolation
constexpr std::int64_t kVelocityBaseline = 50000;  // microseconds: longer than the jitter of stamps
constexpr double kShift = 1.0;                     // seconds: more than a queue or a sweep delays a pose

/// The pose at `part` of the way from `a` to `b`; `part` may exceed 1.
Pose between(const Pose& a, const Pose& b, double part) {
  return renormalised(a * se3_exp(part * se3_log(a.inverse() * b)));
}

double seconds_between(std::int64_t from, std::int64_t to) {
  return 1e-6 * static_cast<double>(to - from);
}

double part_of(std::int64_t utime, std::int64_t from, std::int64_t to) {
  return static_cast<double>(utime - from) / static_cast<double>(to - from);
}

}  // namespace

PriorBuffer::Addition PriorBuffer::add(std::int64_t utime, const Pose& pose) {
  if (!pose.matrix().allFinite()) return Addition::kNotFinite;
  Addition addition = Addition::kTaken;
  if (!samples_.empty() && utime <= samples_.back().utime) {
    if (samples_.back().utime - utime <= kRestart) return Addition::kBackward;
    samples_.clear();
    addition = Addition::kRestarted;
  }
  samples_.push_back({utime, pose});
  if (last_asked_) arrival_offset_s_ = seconds_between(*last_asked_, utime);
  while (samples_.size() > kMostSamples || utime - samples_.front().utime > kMemory) samples_.pop_front();
  return addition;
}

PriorBuffer::Answer PriorBuffer::at(std::int64_t utime) {
  Answer answer;
  last_asked_ = utime;
  if (samples_.empty()) {
    answer.absence = Absence::kNever;
    return answer;
  }
  answer.offset_s = seconds_between(utime, samples_.back().utime);
  if (std::abs(answer.offset_s) > kShift && std::abs(arrival_offset_s_.value_or(answer.offset_s)) > kShift) {
    answer.absence = Absence::kShifted;
    return answer;
  }
  answer.pose = utime <= samples_.back().utime ? interpolated(utime) : extrapolated(utime);
  if (!answer.pose) answer.absence = Absence::kStale;
  return answer;
}

std::optional<Pose> PriorBuffer::interpolated(std::int64_t utime) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), utime,
                                      [](const Sample& sample, std::int64_t t) { return sample.utime < t; });
  if (after->utime == utime) return after->pose;
  if (after == samples_.begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (after->utime - before->utime > kMostPause) return std::nullopt;
  return between(before->pose, after->pose, part_of(utime, before->utime, after->utime));
}

std::optional<Pose> PriorBuffer::extrapolated(std::int64_t utime) const {
  const Sample& newest = samples_.back();
  if (utime - newest.utime > kMostAhead) return std::nullopt;
  const auto earlier = std::find_if(samples_.rbegin(), samples_.rend(), [&](const Sample& sample) {
    return newest.utime - sample.utime >= kVelocityBaseline;
  });
  if (earlier == samples_.rend() || newest.utime - earlier->utime > kMostPause) return newest.pose;
  return between(earlier->pose, newest.pose, part_of(utime, earlier->utime, newest.utime));
}

std::string offset_words(double offset_s) {
  char text[48];
  std::snprintf(text, sizeof text, "%.2f s %s", std::abs(offset_s), offset_s < 0 ? "behind" : "ahead");
  return text;
}

}  // namespace scanlock
