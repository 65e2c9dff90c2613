// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/background_search.hpp"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <exception>
#include <utility>

namespace scanlock {
namespace {

/// On Linux a thread has a priority of its own: poses come first where cores are few.
void step_back() {
  constexpr int kNice = 10;
  setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNice);
}

}  // namespace

void BackgroundSearch::start(RecoveryRequest request) {
  if (at_once_) {
    std::promise<RecoveryAnswer> promise;
    promise.set_value(finder_.find(request));
    answer_ = promise.get_future();
    return;
  }
  answer_ = std::async(std::launch::async, [this, request = std::move(request)] {
    step_back();
    return finder_.find(request);
  });
}

std::optional<RecoveryAnswer> BackgroundSearch::poll() {
  if (!answer_.valid() || answer_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return std::nullopt;
  return answer_.get();
}

}  // namespace scanlock
