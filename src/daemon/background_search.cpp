// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "daemon/background_search.hpp"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <utility>

namespace scanlock {
namespace {

/// Lowers the priority of this thread (on Linux, each thread has its own), so that tracking comes first where
/// cores are few. No lower: at nice 10, on a core that other programs kept busy too, a search did not finish
/// within ten seconds.
void step_back() {
  constexpr int kNice = 4;
  setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNice);
}

}  // namespace

BackgroundSearch::~BackgroundSearch() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void BackgroundSearch::start(MapRequest request) {
  if (at_once_) {
    answer_ = worker_.work(request);
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    request_ = std::move(request);
  }
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  wake_.notify_one();
}

std::optional<MapAnswer> BackgroundSearch::poll() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::exchange(answer_, std::nullopt);
}

void BackgroundSearch::run() {
  step_back();
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stop_ || request_; });
    if (stop_) return;
    std::optional<MapRequest> request = std::exchange(request_, std::nullopt);
    lock.unlock();
    std::optional<MapAnswer> answer;
    std::exception_ptr failure;
    try {
      answer = worker_.work(*request);
    } catch (...) {
      failure = std::current_exception();
    }
    request.reset();
    lock.lock();
    answer_ = std::move(answer);
    failure_ = failure;
  }
}

}  // namespace scanlock
