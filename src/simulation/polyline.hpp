// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

namespace scanlock {

/// A curve on the ground plane, parametrised by arc length. Metres, radians.
class Polyline {
 public:
  Polyline() = default;
  /// Points closer than 1 mm to their predecessor are dropped; at least two must remain.
  explicit Polyline(const std::vector<Eigen::Vector2d>& points);

  double length() const { return arc_.back(); }
  const std::vector<Eigen::Vector2d>& points() const { return points_; }
  /// The point at arc length s, clamped to the ends.
  Eigen::Vector2d at(double s) const;
  /// Direction at arc length s, continuous: full turns are added instead of wrapping.
  double heading(double s) const;
  /// Change of heading per metre.
  double curvature(double s) const;

  /// Equally spaced points on the curve.
  Polyline resampled(double spacing) const;
  /// Rounds the corners: filters the curve along its length by three moving averages of `width` metres. The
  /// smallest radius of a rounded right angle is about width / 2.1.
  Polyline smoothed(double spacing, double width) const;
  Polyline reversed() const;
  /// Shifted sideways, to the left when positive.
  Polyline offset(double left) const;

 private:
  std::size_t segment(double s) const;

  std::vector<Eigen::Vector2d> points_;
  std::vector<double> arc_, heading_;
};

}  // namespace scanlock
