// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/pose_box.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace scanlock {
namespace {

/// Without a branch, which would be mispredicted half of the time.
double positive_part(double x) {
  return 0.5 * (x + std::abs(x));
}

}  // namespace

BoxFilter::BoxFilter(const LevelMatches& m) {
  matches_.reserve(m.size());
  for (std::size_t i = 0; i < m.size(); ++i) {
    const double bounding = bounding_limit(m, i), counting = counting_limit(m, i);
    matches_.push_back({m.px[i], m.py[i], m.qx[i], m.qy[i], m.dz[i], bounding * bounding, counting * counting,
                        std::sqrt(m.px[i] * m.px[i] + m.py[i] * m.py[i])});
  }
}

BoxCounts BoxFilter::filter(const PoseBox& box, const std::vector<std::uint32_t>& list,
                            std::vector<std::uint32_t>& kept) {
  if (theta_ != box.centre.theta || half_theta_ != box.half_theta) {
    theta_ = box.centre.theta;
    half_theta_ = box.half_theta;
    cos_ = std::cos(theta_);
    sin_ = std::sin(theta_);
    // The arc of R p reaches from its middle r along -r by up to |r| (1 - cos) and across by up to |r| sin.
    across_ = std::sin(half_theta_);
    along_ = 0.5 * (1 - std::cos(half_theta_));
  }
  const double c = cos_, s = sin_, across = across_, along = along_, middle = 1 - along;
  const double x = box.centre.x, y = box.centre.y, z = box.centre.z;
  const double half_x = box.half_x, half_y = box.half_y, half_z = box.half_z;
  kept.resize(list.size());
  std::uint32_t* out = kept.data();
  BoxCounts counts;
  double levers = 0;
  for (const std::uint32_t i : list) {
    const Packed& m = matches_[i];
    const double rx = c * m.px - s * m.py, ry = s * m.px + c * m.py;
    const double dz = std::abs(m.dz - z);
    const double ax = std::abs(rx), ay = std::abs(ry);
    const double gap_x =
        positive_part(std::abs(m.qx - middle * rx - x) - (half_x + ay * across + ax * along));
    const double gap_y =
        positive_part(std::abs(m.qy - middle * ry - y) - (half_y + ax * across + ay * along));
    const double gap_z = positive_part(dz - half_z);
    const double ux = m.qx - rx - x, uy = m.qy - ry - y;
    *out = i;
    const bool possible = gap_x * gap_x + gap_y * gap_y + gap_z * gap_z <= m.bounding2;
    out += possible;
    levers += m.lever * static_cast<double>(possible);
    counts.at_centre += ux * ux + uy * uy + dz * dz <= m.counting2;
  }
  counts.possible = static_cast<int>(out - kept.data());
  kept.resize(static_cast<std::size_t>(counts.possible));
  if (counts.possible > 0) counts.lever = levers / counts.possible;
  return counts;
}

double longest_side(const PoseBox& box, double lever) {
  return std::max({box.half_x, box.half_y, box.half_z, box.half_theta * lever});
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
  if (longest == box.half_theta * lever) {
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
