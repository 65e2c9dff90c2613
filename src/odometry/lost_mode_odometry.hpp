// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "odometry/keyframe_archive.hpp"
#include "odometry/odometer.hpp"
#include "odometry/surroundings.hpp"

namespace scanlock {

/// Lost-mode odometry: the motion of a lost robot in a map of its scans since it was lost. It begins at the
/// predicted pose, so that its frame is the predicted map frame.
class LostModeOdometry {
 public:
  LostModeOdometry(const TrackerConfig& config, std::int64_t utime, const PreparedScan& scan,
                   const MovingPose& predicted);

  /// Follows one scan, `dt` seconds after the last one. False for a scan that does not fit: the odometry
  /// begins anew with it, at its predicted pose.
  bool follow(std::int64_t utime, double dt, const PreparedScan& scan);
  /// Predicts the state at a scan without points, `dt` seconds after the last one.
  void coast(double dt);

  /// The upward direction by an attitude sensor, for the scan that was followed last; body axes, unit.
  void note_up(const Eigen::Vector3d& up_in_body);
  /// The mean upward direction since the odometry began, unit, axes of the predicted map frame; empty without
  /// an attitude sensor.
  std::optional<Eigen::Vector3d> up() const;

  const MovingPose& state() const { return odometer_->state(); }
  const Matrix12& covariance() const { return odometer_->covariance(); }
  const Odometer& odometer() const { return *odometer_; }
  /// The keyframes since the odometry began, in the predicted map frame.
  const KeyframeArchive& seen() const { return seen_; }
  bool planar() const { return odometer_->planar(); }
  /// Number of scans since the odometry began, including the first.
  int scans() const { return scans_; }
  /// Seconds for which scans have fitted each other, since the odometry began.
  double followed_s() const { return followed_s_; }
  /// The alignment of the last scan that was followed.
  const Attempt& attempt() const { return attempt_; }

  /// The input of a search for the pose; its `scene` is 0 until a scan was followed.
  Surroundings surroundings() const;
  /// Gives the odometer to the caller; this object must not be used afterwards.
  std::unique_ptr<Odometer> take_odometer() { return std::move(odometer_); }

 private:
  void begin_anew(std::int64_t utime, const PreparedScan& scan, const MovingPose& predicted);
  void remember(std::int64_t utime, const PreparedScan& scan);

  TrackerConfig config_;
  std::unique_ptr<Odometer> odometer_;
  KeyframeArchive seen_;
  int scans_ = 1;
  Eigen::Vector3d up_sum_ = Eigen::Vector3d::Zero();
  double followed_s_ = 0;
  Attempt attempt_;
  double blind_s_ = 0;  ///< seconds since the last scan that was followed
};

}  // namespace scanlock
