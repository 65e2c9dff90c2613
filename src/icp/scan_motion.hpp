// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "geometry/rigid.hpp"

namespace scanlock {

/// Displacement of an accelerating body from its motion at constant twist, at t seconds from the stamp, per
/// unit of acceleration (s^2). It is zero at the stamp and equal at both ends of the scan, so that the twist
/// is the mean velocity of the scan. `middle`: of the times of the scan, seconds from the stamp.
inline double bend_at(double t, double middle) {
  return 0.5 * t * (t - 2 * middle);
}

/// Variance of the acceleration of the parabola that fits a motion best (least squares over `seconds`), if
/// the true acceleration is white noise of power spectral density one: the fit weights an impulse at the
/// share s of the time by 30 s^2 (1 - s)^2, and the integral of its square is 900 B(5, 5) = 10 / 7.
inline double acceleration_variance(double seconds) {
  return 10.0 / 7.0 / seconds;
}

/// exp(t * twist + bend_at(t) * acceleration) for the times of a scan: exact at kKnots + 1 instants (knots),
/// interpolated linearly in between. At 180 deg/s over 0.1 s the interpolation error is at most 1e-5 rad.
class ScanMotion {
 public:
  static constexpr int kKnots = 32;

  /// Times in seconds relative to the stamp; empty: all points at the stamp.
  void set_times(const std::vector<float>& times);
  void set_motion(const Vector6& twist, const Vector6& acceleration, double middle);

  bool still() const { return still_; }  ///< no times: every point is at the stamp
  double knot_time(int knot) const { return first_ + knot * step_; }
  double middle() const { return still_ ? 0.0 : knot_time(0) + 0.5 * kKnots * step_; }
  const Pose& knot_pose(int knot) const { return poses_[static_cast<std::size_t>(knot)]; }
  /// The knot nearest to a point's time.
  int nearest_knot(std::size_t point) const {
    return still_ ? 0 : knots_[point] + (fractions_[point] > 0.5f ? 1 : 0);
  }

  /// Transforms point `i`, with coordinates p (metres) in the body frame at its own time, to the body frame
  /// at the stamp.
  Eigen::Vector3f at_stamp(std::size_t i, const Eigen::Vector3f& p) const {
    if (still_) return p;
    const std::size_t k = static_cast<std::size_t>(knots_[i]);
    const Eigen::Vector3f a = rotations_[k] * p + translations_[k];
    const Eigen::Vector3f b = rotations_[k + 1] * p + translations_[k + 1];
    return a + fractions_[i] * (b - a);
  }

 private:
  bool still_ = true;
  double first_ = 0, step_ = 0;
  std::vector<int> knots_;
  std::vector<float> fractions_;
  std::array<Pose, kKnots + 1> poses_;
  std::array<Eigen::Matrix3f, kKnots + 1> rotations_;
  std::array<Eigen::Vector3f, kKnots + 1> translations_;
};

}  // namespace scanlock
