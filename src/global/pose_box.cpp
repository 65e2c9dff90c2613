// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/pose_box.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/angles.hpp"

namespace scanlock {
namespace {

constexpr double kTurnWeight = 2.5;

/// Without a branch, which would be mispredicted half of the time.
template <typename T>
T positive_part(T x) {
  return T(0.5) * (x + std::abs(x));
}

}  // namespace

BoxFilter::BoxFilter(const LevelMatches& m) {
  matches_.reserve(m.size());
  for (std::size_t i = 0; i < m.size(); ++i) {
    const double bounding = bounding_limit(m, i), counting = counting_limit(m, i);
    const double square = m.px[i] * m.px[i] + m.py[i] * m.py[i], lever = std::sqrt(square);
    constexpr double kUp = 1 + 1e-6, kTiny = 1e-15;  // rounding to float
    matches_.push_back({m.px[i], m.py[i], m.qx[i], m.qy[i], m.dz[i], bounding * bounding, counting * counting,
                        lever, static_cast<float>(bounding * kUp), static_cast<float>(0.5 / (bounding * kUp)),
                        static_cast<float>(kUp / std::max(lever, kTiny)),
                        static_cast<float>(kUp / std::max(square, kTiny * kTiny))});
  }
}

void BoxFilter::set_angles(double theta, double half_theta) {
  if (theta_ == theta && half_theta_ == half_theta) return;
  theta_ = theta;
  half_theta_ = half_theta;
  cos_ = std::cos(theta_);
  sin_ = std::sin(theta_);
  // The arc of R p reaches from its middle r along -r by up to |r| (1 - cos) and across by up to |r| sin.
  across_ = std::sin(half_theta_);
  along_ = 0.5 * (1 - std::cos(half_theta_));
}

namespace {

constexpr int kBins = 16;  // of an axis

/// Narrows a side to the bins that so many intervals can meet in; false when there are none.
bool narrow(const std::array<int, kBins>& starts, const std::array<int, kBins>& ends, int wanted,
            double& centre, double& half) {
  int before = 0, last = -1, depth = 0;  // bins before the first
  for (int b = 0; b < kBins; ++b) {
    depth += starts[static_cast<std::size_t>(b)];
    const bool enough = depth >= wanted;
    last = enough ? b : last;
    before += last < 0;
    depth -= ends[static_cast<std::size_t>(b)];
  }
  if (last < 0) return false;
  if (before == 0 && last == kBins - 1) return true;
  centre += half * (before + last + 1 - kBins) / kBins;
  half *= (last + 1 - before) * (1 + 1e-12) / kBins;
  return true;
}

}  // namespace

void BoxFilter::measure(const PoseBox& box, const std::vector<std::uint32_t>& list) {
  const double c = cos_, s = sin_, middle = 1 - along_;
  const auto across = static_cast<float>(across_), along = static_cast<float>(along_);
  const auto half_x = static_cast<float>(box.half_x), half_y = static_cast<float>(box.half_y),
             half_z = static_cast<float>(box.half_z), half_theta = static_cast<float>(box.half_theta);
  const float sine = half_theta * half_theta * half_theta / 6;  // how far d may be from sin d
  const std::size_t n = list.size();
  for (int axis = 0; axis < 4; ++axis) {
    middle_[axis].resize(n);
    reach_[axis].resize(n);
  }
  for (std::size_t k = 0; k < n; ++k) {
    const Packed& m = matches_[list[k]];
    const double dx = c * m.px - s * m.py, dy = s * m.px + c * m.py;
    const double ex = m.qx - box.centre.x, ey = m.qy - box.centre.y;
    const auto rx = static_cast<float>(dx), ry = static_cast<float>(dy);
    const auto tx = static_cast<float>(ex - middle * dx), ty = static_cast<float>(ey - middle * dy);
    const auto ux = static_cast<float>(ex - dx), uy = static_cast<float>(ey - dy);
    const auto tz = static_cast<float>(m.dz - box.centre.z);
    const float ax = std::abs(rx), ay = std::abs(ry);
    const float sweep_x = ay * across + ax * along, sweep_y = ax * across + ay * along;
    const float gx = positive_part(std::abs(tx) - (half_x + sweep_x));
    const float gy = positive_part(std::abs(ty) - (half_y + sweep_y));
    const float gz = positive_part(std::abs(tz) - half_z);
    // sqrt(r^2 - g^2) <= r - g^2 / (2 r)
    const float xx = gx * gx * m.shrink, yy = gy * gy * m.shrink, zz = gz * gz * m.shrink;
    middle_[0][k] = tx;
    reach_[0][k] = m.reach - yy - zz + sweep_x;
    middle_[1][k] = ty;
    reach_[1][k] = m.reach - xx - zz + sweep_y;
    middle_[2][k] = tz;
    reach_[2][k] = m.reach - xx - yy;
    // Along the tangent of its arc, R p is off by a length at the middle, and moves by |p| sin d.
    middle_[3][k] = (uy * rx - ux * ry) * m.inverse2;
    reach_[3][k] = (m.reach - zz) * m.inverse + (half_x * ay + half_y * ax) * m.inverse2 + sine;
  }
}

bool BoxFilter::contract(const std::vector<std::uint32_t>& list, int wanted, PoseBox& box) {
  if (static_cast<int>(list.size()) < wanted) return false;
  set_angles(box.centre.theta, box.half_theta);
  measure(box, list);
  double LevelPose::*const centres[] = {&LevelPose::x, &LevelPose::y, &LevelPose::z, &LevelPose::theta};
  double PoseBox::*const halves[] = {&PoseBox::half_x, &PoseBox::half_y, &PoseBox::half_z,
                                     &PoseBox::half_theta};
  const auto n = static_cast<Eigen::Index>(list.size());
  first_.resize(n);
  last_.resize(n);
  for (std::size_t axis = 0; axis < 4; ++axis) {
    constexpr float kMargin = 0.01f, kUp = 1.000002f;  // bins, and a factor: more than rounding
    const float scale = 0.5f * kBins / static_cast<float>(box.*halves[axis]);
    const Eigen::Map<const Eigen::ArrayXf> middle(middle_[axis].data(), n), reach(reach_[axis].data(), n);
    const auto around = reach.max(0.0f) * kUp + middle.abs() * (kUp - 1);
    first_ = (middle - around) * scale + (0.5f * kBins - kMargin);
    last_ = (middle + around) * scale + (0.5f * kBins + kMargin);
    // Most intervals of a small box reach through all of it.
    int through = 0;
    std::array<int, kBins> starts{}, ends{};
    for (Eigen::Index k = 0; k < n; ++k) {
      if ((first_[k] < 1) & (last_[k] >= kBins - 1)) {
        ++through;
        continue;
      }
      ++starts[static_cast<std::size_t>(std::max(0.0f, std::min(first_[k], kBins - 1.0f)))];
      ++ends[static_cast<std::size_t>(std::max(0.0f, std::min(last_[k], kBins - 1.0f)))];
    }
    if (through >= wanted) continue;
    if (!narrow(starts, ends, wanted - through, box.centre.*centres[axis], box.*halves[axis])) return false;
  }
  return true;
}

BoxCounts BoxFilter::filter(const PoseBox& box, const std::vector<std::uint32_t>& list,
                            std::vector<std::uint32_t>& kept) {
  set_angles(box.centre.theta, box.half_theta);
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
