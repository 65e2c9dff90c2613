// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "odometry/odometer.hpp"
#include "odometry/trusted_scan.hpp"

namespace scanlock {

/// Decides whether the alignment of a scan with the local map is trusted: by its energy, and by the log odds
/// of a kidnap to a place that looks like the expected one (see KidnapEvidence). The bound of the distance
/// from the prediction is narrower from a distrusted scan until the next trusted one.
class AlignmentCheck {
 public:
  /// Starts anew, without a trusted scan: the robot is at `pose` (map frame) at `time` (microseconds).
  void restart(const Pose& pose, std::int64_t time);
  /// The scan at `now` (microseconds) is trusted, at the pose and velocity `moving`. `witness`: later scans
  /// are tested for contradiction with it.
  void trust(std::int64_t now, const PreparedScan& scan, const MovingPose& moving, bool witness);
  /// A scan is not trusted. `kidnapped`: because of is_kidnapped().
  void distrust(bool kidnapped);

  /// The last trusted scan.
  const TrustedScan& last() const { return last_; }
  /// Seconds since the last trusted scan.
  double unseen_s(std::int64_t now) const;
  /// Number of scans since the last trusted one.
  int distrusted_scans() const { return distrusted_scans_; }
  /// Whether is_kidnapped() held for a scan since the last trusted one: the robot may be at another place
  /// that looks like the expected one.
  bool looks_alike() const { return looks_alike_; }

  /// Whether the motion from the prediction to the alignment is physically plausible, by pose and velocity
  /// together (see squared_gap).
  bool is_plausible(const Attempt& attempt) const;
  /// Whether the alignment explains its scan, and is plausible.
  bool is_trusted(const Attempt& attempt) const;
  /// Whether a robot whose alignment explains the scan has likelier been carried elsewhere, which is the
  /// likelier the longer no scan was trusted. `expected`: the prediction by other sensors, else the prior.
  /// False for the first few scans, whose motion is not known well enough.
  bool is_kidnapped(std::int64_t now, const PreparedScan& scan, const MotionPrior& expected,
                    const Attempt& attempt) const;

 private:
  TrustedScan last_;
  int distrusted_scans_ = 0;
  bool looks_alike_ = false;
};

}  // namespace scanlock
