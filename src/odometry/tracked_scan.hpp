// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "geometry/rigid.hpp"
#include "odometry/recovery.hpp"

namespace scanlock {

/// The quality of a pose. The numbers are part of the message contract.
enum class TrackingState : std::int8_t {
  kInitialising = 0,  ///< no map yet
  kTracking = 1,      ///< aligned with the map
  /// Aligned, but less certain than TRACKING promises (99 of 100 poses are within 0.05 m and 1 degree,
  /// relative to the map around the robot; `degenerate_axes` are the axes along which this does not hold), or
  /// data is missing: scans, or inliers, which are fewer than 0.4 of the points of a scan; or the position
  /// was not observed while a submap was begun.
  kDegraded = 2,
  kRecovering = 3,  ///< the energy jumped: a global search runs, the pose is predicted
  kAmbiguous = 4,   ///< two hypotheses explain the scan equally well; no jump was made
  kLost = 5,        ///< no certified hypothesis; the pose is predicted, the map is frozen
};
const char* to_string(TrackingState state);

/// The source of the pose of a scan.
enum class PoseMethod : std::int8_t { kNone = 0, kIcp = 1, kGlobal = 2, kPredicted = 3 };
const char* to_string(PoseMethod method);

/// Why the alignment of a scan ended.
enum class StopReason : std::int8_t {
  kNone = 0,
  kConverged = 1,
  kIterations = 2,
  kTooFewPoints = 3,
  kDiverged = 4
};
const char* to_string(StopReason reason);

/// Whether a scan was used. A rejected stamp leaves the state of the tracker as it was; for an empty scan the
/// pose is predicted.
enum class ScanVerdict : std::int8_t {
  kTracked = 0,
  kEmpty = 1,          ///< too few finite points within the range limits
  kDuplicateTime = 2,  ///< same utime as the scan before
  kBackwardTime = 3,   ///< up to a second earlier than the scan before, by a clock that is regular
  kOtherClock = 4,     ///< stamped by another clock than the scans around it
};
const char* to_string(ScanVerdict verdict);

/// Whether a loop closure that moves one pose to another begins a new epoch: beyond 0.05 m or 0.5 degrees.
bool is_jump(const Pose& from, const Pose& to);

/// The end of one attempt at relocalisation, or a loop closure, and its evidence.
struct Recovery {
  RecoveryAnswer search;
  bool accepted = false;
  bool loop_closure = false;                   ///< a correction of the map, without a search
  std::string reason;                          ///< why, in words
  std::uint32_t epoch = 0;                     ///< of the scan it is reported with; an acceptance begins it
  Pose map_from_body = Pose::Identity();       ///< at the scan it is reported with
  Pose map_from_predicted = Pose::Identity();  ///< correction of the poses before
  double energy_before = 1;                    ///< of the scan that was lost, 0 to 1
  double energy_after = 1;                     ///< at the hypothesis, after refinement
};

/// The result of one scan. Frames: `map` is the pose of the first scan; `body` is the sensor at the stamp.
struct TrackedScan {
  std::int64_t utime = 0;
  ScanVerdict verdict = ScanVerdict::kTracked;
  std::string why;  ///< the reason why the scan was not used, in words; else empty
  TrackingState state = TrackingState::kInitialising;
  PoseMethod method = PoseMethod::kNone;
  StopReason stop_reason = StopReason::kNone;
  Pose map_from_body = Pose::Identity();  ///< holds at exactly `utime`
  /// The same motion in a frame that never jumps, and drifts instead.
  Pose local_from_body = Pose::Identity();
  Vector6 twist = Vector6::Zero();  ///< body velocity [m/s; rad/s], in the body frame
  Matrix6 covariance =
      Matrix6::Zero();  ///< of the pose, right perturbation: T exp(xi), order [u; phi], in the body frame
  std::uint32_t degenerate_axes = 0;  ///< bit 0..2: x y z translation, 3..5: rotation about x y z (body axes)
  std::uint32_t epoch = 0;            ///< counts the jumps of the map frame
  bool localised = true;  ///< false: a map was loaded, and the robot has not been localised in it so far
  /// Set where the clock of the scans stepped: the stamp of the last scan by the old clock, microseconds.
  std::optional<std::int64_t> clock_step_from;
  bool interleaved = false;    ///< the scans rejected lately are stamped by one other clock: two publishers
  int iterations = 0;          ///< of the alignment
  int points_in = 0;           ///< points of the scan as it came
  int points_used = 0;         ///< source points of the alignment
  int inliers = 0;             ///< of those, within three scales of their surface
  double energy = 0;           ///< mean Welsch energy per source point at a fixed scale, 0 to 1
  double energy_baseline = 0;  ///< its recent median
  double energy_score = 0;     ///< robust z-score of the energy against its history
  int keyframes = 0;
  int map_points = 0;
  int loop_closures = 0;               ///< accepted so far
  std::optional<std::uint32_t> stamp;  ///< see PoseHistory; none where no history is kept
  std::optional<Recovery> recovery;    ///< the attempt that ended with this scan
  /// Why stored points of the map could not be read (see PointsUnreadable); empty where all could. The map
  /// then stays as it is, without them.
  std::string map_fault;
};

}  // namespace scanlock
