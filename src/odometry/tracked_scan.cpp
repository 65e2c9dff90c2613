// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "odometry/tracked_scan.hpp"

#include "geometry/angles.hpp"

namespace scanlock {
namespace {

constexpr double kJumpMetres = 0.05, kJumpRadians = 0.5 * kDegree;

}  // namespace

bool is_jump(const Pose& from, const Pose& to) {
  return !near(from, to, kJumpMetres, kJumpRadians);
}

const char* to_string(TrackingState state) {
  switch (state) {
    case TrackingState::kInitialising:
      return "INITIALISING";
    case TrackingState::kTracking:
      return "TRACKING";
    case TrackingState::kDegraded:
      return "DEGRADED";
    case TrackingState::kRecovering:
      return "RECOVERING";
    case TrackingState::kAmbiguous:
      return "AMBIGUOUS";
    case TrackingState::kLost:
      return "LOST";
  }
  return "?";
}

const char* to_string(PoseMethod method) {
  switch (method) {
    case PoseMethod::kNone:
      return "none";
    case PoseMethod::kIcp:
      return "icp";
    case PoseMethod::kGlobal:
      return "global";
    case PoseMethod::kPredicted:
      return "predicted";
  }
  return "?";
}

const char* to_string(StopReason reason) {
  switch (reason) {
    case StopReason::kNone:
      return "none";
    case StopReason::kConverged:
      return "converged";
    case StopReason::kIterations:
      return "iteration limit";
    case StopReason::kTooFewPoints:
      return "too few points";
    case StopReason::kDiverged:
      return "diverged";
  }
  return "?";
}

const char* to_string(ScanVerdict verdict) {
  switch (verdict) {
    case ScanVerdict::kTracked:
      return "tracked";
    case ScanVerdict::kEmpty:
      return "empty";
    case ScanVerdict::kDuplicateTime:
      return "duplicate utime";
    case ScanVerdict::kBackwardTime:
      return "backward utime";
    case ScanVerdict::kOtherClock:
      return "utime of another clock";
  }
  return "?";
}

}  // namespace scanlock
