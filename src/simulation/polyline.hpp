// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

namespace scanlock {

/// A curve on the ground plane, by arc length. Metres, radians.
class Polyline {
 public:
  Polyline() = default;
  /// Points closer than a millimetre to their predecessor are dropped; at least two must remain.
  explicit Polyline(const std::vector<Eigen::Vector2d>& points);

  double length() const { return arc_.back(); }
  const std::vector<Eigen::Vector2d>& points() const { return points_; }
  /// The point at arc length s; beyond the ends, the end.
  Eigen::Vector2d at(double s) const;
  /// Direction at arc length s, continuous: it counts full turns instead of wrapping.
  double heading(double s) const;
  /// Change of heading a metre.
  double curvature(double s) const;

  /// Equally spaced points on the curve.
  Polyline resampled(double spacing) const;
  /// Rounds the corners: the curve filtered along its length by three moving averages of `width`.
  /// A right angle becomes a bend of radius about width / 2.1 at its tightest.
  Polyline smoothed(double spacing, double width) const;
  Polyline reversed() const;
  /// Moved sideways, to the left when positive.
  Polyline offset(double left) const;

 private:
  std::size_t segment(double s) const;

  std::vector<Eigen::Vector2d> points_;
  std::vector<double> arc_, heading_;
};

}  // namespace scanlock
