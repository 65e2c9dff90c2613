// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "global/matches.hpp"

namespace scanlock {

/// A box of levelled poses: centre and half sides, closed.
struct PoseBox {
  LevelPose centre;
  double half_x = 0, half_y = 0, half_z = 0;  ///< metres
  double half_theta = 0;                      ///< radians, at most a quarter turn
};

/// What a box can hold.
struct BoxCounts {
  int possible = 0;   ///< matches that some pose of the box may hold: bounds the consensus in the box
  int at_centre = 0;  ///< matches that its centre holds: that pose's consensus
  double lever = 0;   ///< metres: mean distance of the possible matches' p from the axis
};

/// Counts matches in boxes. Height, horizontal axes and angle are bounded apart, which is tighter than the
/// paper's ball around a cube (equation 14): while theta sweeps the box, R p runs along an arc, and q - R p
/// stays in the rectangle about that arc; its gaps to the box make a Euclidean distance that every pose of
/// the box exceeds.
class BoxFilter {
 public:
  explicit BoxFilter(const LevelMatches& matches);
  /// Replaces `kept` by the possible ones of `list`.
  BoxCounts filter(const PoseBox& box, const std::vector<std::uint32_t>& list,
                   std::vector<std::uint32_t>& kept);
  /// Shrinks the box to where so many of the matches, all of them possible, can meet: along each axis a match
  /// leaves an interval, and the box need not reach beyond where enough of these overlap. False when that is
  /// nowhere.
  bool contract(const std::vector<std::uint32_t>& list, int wanted, PoseBox& box);

 private:
  void set_angles(double theta, double half_theta);
  void measure(const PoseBox& box, const std::vector<std::uint32_t>& list);
  struct Packed {
    double px, py, qx, qy, dz, bounding2, counting2, lever;
    float reach, shrink, inverse, inverse2;  // the bounding limit, half of 1 / that, 1 / lever, 1 / lever^2
  };
  std::vector<Packed> matches_;
  // Of the last box, for its sister often has the same angles.
  double theta_ = 0, half_theta_ = 0, cos_ = 1, sin_ = 0, across_ = 0, along_ = 0;
  // Of contract(): an interval about the centre of the box for each match, along x, y, z and theta; and, of
  // one axis, its ends in bins.
  std::array<std::vector<float>, 4> middle_, reach_;
  Eigen::ArrayXf first_, last_;
};

/// Half of the longest side, metres; angles are measured by what they move at `lever` from the axis.
double longest_side(const PoseBox& box, double lever);

/// Halves the longest side; the halves overlap by rounding.
void halve(const PoseBox& box, double lever, PoseBox halves[2]);

/// Poses that do not count: both the angle and the translation are near.
struct ExcludedPoses {
  LevelPose centre;
  double angle = 0;     ///< radians
  double distance = 0;  ///< metres
  bool holds(const LevelPose& pose) const;
  bool holds(const PoseBox& box) const;
};

}  // namespace scanlock
