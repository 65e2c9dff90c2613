// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/silence.hpp"

#include <cstdio>

namespace scanlock {
namespace {

std::int64_t usable(const Counters& counters) {
  return counters.received - counters.rejected();
}

std::string seconds(std::chrono::duration<double> duration) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", duration.count());
  return text;
}

}  // namespace

SilenceWatch::SilenceWatch(std::string channels, double patience_s, std::chrono::steady_clock::time_point now)
    : channels_(std::move(channels)), patience_(patience_s), next_warning_(patience_s), last_usable_(now) {}

std::optional<SilenceWatch::Line> SilenceWatch::look(const Counters& counters,
                                                     std::chrono::steady_clock::time_point now) {
  const std::chrono::duration<double> silence = now - last_usable_;
  if (usable(counters) > usable(then_)) {
    const bool were_silent = silent_;
    last_usable_ = now;
    then_ = counters;
    silent_ = false;
    next_warning_ = patience_;
    if (!were_silent) return std::nullopt;
    return Line{false, "scans are back after " + seconds(silence)};
  }
  if (silence < next_warning_) return std::nullopt;
  silent_ = true;
  next_warning_ = silence * 2;
  return Line{true, "no usable scan for " + seconds(silence) + ": " + reason(counters)};
}

std::string SilenceWatch::reason(const Counters& counters) const {
  const std::int64_t rejected = counters.rejected() - then_.rejected();
  const std::int64_t drops = counters.kernel_drops - then_.kernel_drops;
  if (rejected > 0) {
    return std::to_string(rejected) +
           " messages came and were rejected, the last because of: " + counters.last_error;
  }
  if (drops > 0) {
    return "the kernel dropped " + std::to_string(drops) +
           " datagrams; scanlockd --check names the command that mends it";
  }
  const bool pattern = channels_.find_first_of("*[(\\") != std::string::npos;
  return "nothing came on " + channels_ + (pattern ? " (names of channels are literal, not patterns)" : "") +
         "; is a driver publishing there, on this URL? scanlockd --check listens for you";
}

}  // namespace scanlock
