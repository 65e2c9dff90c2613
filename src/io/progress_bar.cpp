// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "io/progress_bar.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace scanlock {

ProgressBar::ProgressBar(std::string label)
    : label_(std::move(label)),
      terminal_(isatty(STDERR_FILENO) == 1),
      next_(Clock::now() + std::chrono::seconds(2)) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fprintf(stderr, "\r\033[K");
}

void ProgressBar::update(std::uint64_t done, std::uint64_t total) {
  if (!terminal_ || Clock::now() < next_) return;
  constexpr int kWidth = 40;
  const double part =
      total == 0 ? 1.0 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
  const std::string bar(static_cast<std::size_t>(part * kWidth), '#');
  std::fprintf(stderr, "\r%s [%-*s] %3.0f %%", label_.c_str(), kWidth, bar.c_str(), part * 100);
  drawn_ = true;
  next_ = Clock::now() + std::chrono::milliseconds(100);
}

}  // namespace scanlock
