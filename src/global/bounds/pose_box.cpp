// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/bounds/pose_box.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace scanlock {
namespace {

constexpr double kTurnWeight = 2.5;

}  // namespace

double longest_side(const PoseBox& box, double lever) {
  return std::max({box.half_x, box.half_y, box.half_z, kTurnWeight * box.half_theta * lever});
}

void halve(const PoseBox& box, double lever, PoseBox halves[2]) {
  const double longest = longest_side(box, lever);
  halves[0] = halves[1] = box;
  const auto split = [&](double LevelPose::*centre, double PoseBox::*half) {
    const double quarter = 0.5 * (box.*half);
    for (int k = 0; k < 2; ++k) {
      halves[k].centre.*centre += k == 0 ? -quarter : quarter;
      halves[k].*half = quarter * (1 + 1e-12);
    }
  };
  if (longest == kTurnWeight * box.half_theta * lever) {
    split(&LevelPose::theta, &PoseBox::half_theta);
  } else if (longest == box.half_x) {
    split(&LevelPose::x, &PoseBox::half_x);
  } else if (longest == box.half_y) {
    split(&LevelPose::y, &PoseBox::half_y);
  } else {
    split(&LevelPose::z, &PoseBox::half_z);
  }
}

bool ExcludedPoses::holds(const LevelPose& pose) const {
  PoseBox box;
  box.centre = pose;
  return holds(box);
}

bool ExcludedPoses::holds(const PoseBox& box) const {
  const double dx = std::abs(box.centre.x - centre.x) + box.half_x,
               dy = std::abs(box.centre.y - centre.y) + box.half_y,
               dz = std::abs(box.centre.z - centre.z) + box.half_z;
  return dx * dx + dy * dy + dz * dz <= distance * distance &&
         std::abs(std::remainder(box.centre.theta - centre.theta, 2 * kPi)) + box.half_theta <= angle;
}

}  // namespace scanlock
