// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/stop_signal.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

namespace scanlock {
namespace {

constexpr std::int64_t kLongestPoll = 3600000;  // milliseconds; poll() takes them as an int

}  // namespace

StopSignal::StopSignal() : event_fd_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (event_fd_ < 0) throw std::runtime_error(std::string("eventfd: ") + std::strerror(errno));
}

StopSignal::~StopSignal() {
  close(event_fd_);
}

void StopSignal::request() {
  requested_ = true;
  const std::uint64_t one = 1;
  const ssize_t written = write(event_fd_, &one, sizeof one);
  static_cast<void>(written);  // it fails only when a request is pending already
}

bool StopSignal::wait_for(std::chrono::milliseconds duration) const {
  return wait_for_input(-1, duration) == Event::kStop;
}

StopSignal::Event StopSignal::wait_for_input(int fd, std::chrono::milliseconds duration) const {
  const auto end = std::chrono::steady_clock::now() + duration;
  pollfd watched[2] = {{event_fd_, POLLIN, 0}, {fd, POLLIN, 0}};
  while (!requested_) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now()).count();
    if (left <= 0 && duration.count() > 0) return Event::kTimeout;
    const int ready = poll(watched, 2, static_cast<int>(std::clamp<std::int64_t>(left, 0, kLongestPoll)));
    if (requested_) return Event::kStop;
    if (ready > 0 && watched[1].revents != 0) return Event::kInput;
    if (ready < 0 && errno != EINTR) return Event::kTimeout;
    if (duration.count() <= 0) return Event::kTimeout;
  }
  return Event::kStop;
}

}  // namespace scanlock
