// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include "global/matches.hpp"

namespace scanlock {

/// A box of levelled poses: centre and half sides, closed.
struct PoseBox {
  LevelPose centre;
  double half_x = 0, half_y = 0, half_z = 0;  ///< metres
  double half_theta = 0;                      ///< radians, at most a quarter turn
};

/// Half of the longest side, metres; an angle counts as 2.5 times the displacement that it causes at `lever`
/// metres from the axis.
double longest_side(const PoseBox& box, double lever);

/// Halves the longest side; the halves overlap by rounding.
void halve(const PoseBox& box, double lever, PoseBox halves[2]);

/// Poses near `centre` in both angle and translation, which a search excludes.
struct ExcludedPoses {
  LevelPose centre;
  double angle = 0;     ///< radians
  double distance = 0;  ///< metres
  bool holds(const LevelPose& pose) const;
  bool holds(const PoseBox& box) const;
};

}  // namespace scanlock
