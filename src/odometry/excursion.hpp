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

/// What a lost robot still knows: how it moves, and what it sees on its way. Odometry over a map of its own,
/// begun where the robot was believed to be, so that its frame is the predicted map frame.
class Excursion {
 public:
  Excursion(const TrackerConfig& config, std::int64_t utime, const PreparedScan& scan,
            const MovingPose& predicted);

  /// Follows one scan, `dt` seconds after the last one. A scan that does not fit begins it anew where it was
  /// predicted: false then.
  bool follow(std::int64_t utime, double dt, const PreparedScan& scan);
  /// The same for a scan without points.
  void coast(double dt);

  /// Which way is up, by an attitude sensor, for the scan that was followed last.
  void note_up(const Eigen::Vector3d& up_in_body);
  /// The mean of that since it began, axes of the predicted map frame; nothing without such a sensor.
  std::optional<Eigen::Vector3d> up() const;

  const MovingPose& state() const { return odometer_->state(); }
  const Matrix12& covariance() const { return odometer_->covariance(); }
  const Odometer& odometer() const { return *odometer_; }
  /// The places that it has been to since it began, in the predicted map frame.
  const KeyframeArchive& seen() const { return seen_; }
  bool planar() const { return odometer_->planar(); }
  /// Scans since it began.
  int scans() const { return scans_; }
  /// Seconds that it has followed scans that fit each other.
  double followed_s() const { return followed_s_; }
  /// Of the last scan that was followed.
  const Attempt& attempt() const { return attempt_; }

  /// Their scene is 0 until it has followed a scan.
  Surroundings surroundings() const;
  /// Its odometer, for whoever goes on with it; the excursion is at its end.
  std::unique_ptr<Odometer> take_odometer() { return std::move(odometer_); }

 private:
  void begin_anew(std::int64_t utime, const PreparedScan& scan, const MovingPose& predicted);
  bool is_bent(const Vector6& velocity, const Vector6& way);

  void remember(std::int64_t utime, const PreparedScan& scan);

  TrackerConfig config_;
  std::unique_ptr<Odometer> odometer_;
  KeyframeArchive seen_;
  int scans_ = 1;
  Vector6 bend_ = Vector6::Zero();  ///< velocity, less what the way from scan to scan says; a mean
  Eigen::Vector3d up_sum_ = Eigen::Vector3d::Zero();
  double followed_s_ = 0;
  Attempt attempt_;
  double blind_s_ = 0;  ///< since the last scan that was followed
};

}  // namespace scanlock
