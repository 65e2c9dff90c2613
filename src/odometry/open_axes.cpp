// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/open_axes.hpp"

#include <algorithm>

namespace scanlock {
namespace {

constexpr int kMostOpen = 20, kStillOpen = 5;  // scans

}  // namespace

std::uint32_t OpenAxes::note(std::uint32_t axes) {
  if (axes != 0) {
    last_ = axes;
    scans_ = std::min(scans_ + 1, kMostOpen);
    return axes;
  }
  scans_ = std::max(scans_ - 1, 0);
  return scans_ >= kStillOpen ? last_ : 0;
}

}  // namespace scanlock
