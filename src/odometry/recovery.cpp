// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/recovery.hpp"

namespace scanlock {

struct PlaceFinder::Target {};

PlaceFinder::PlaceFinder() = default;
PlaceFinder::~PlaceFinder() = default;
PlaceFinder::PlaceFinder(PlaceFinder&&) noexcept = default;
PlaceFinder& PlaceFinder::operator=(PlaceFinder&&) noexcept = default;

RecoveryAnswer PlaceFinder::find(const RecoveryRequest& request) {
  RecoveryAnswer answer;
  answer.serial = request.serial;
  answer.utime = request.utime;
  answer.reason = "no search yet";
  return answer;
}

}  // namespace scanlock
