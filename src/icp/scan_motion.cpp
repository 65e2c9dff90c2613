// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "icp/scan_motion.hpp"

#include <algorithm>
#include <cmath>

namespace scanlock {

void ScanMotion::set_times(const std::vector<float>& times) {
  still_ = true;
  poses_[0] = Pose::Identity();
  first_ = step_ = 0;
  if (times.empty()) return;
  const auto [least, greatest] = std::minmax_element(times.begin(), times.end());
  if (*least == 0.0f && *greatest == 0.0f) return;
  still_ = false;
  first_ = *least;
  // Not zero, also where all times are one instant other than the stamp.
  step_ = std::max(static_cast<double>(*greatest) - first_, 1e-6) / kKnots;
  knots_.resize(times.size());
  fractions_.resize(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double position = (times[i] - first_) / step_;
    const int knot = std::clamp(static_cast<int>(position), 0, kKnots - 1);
    knots_[i] = knot;
    fractions_[i] = static_cast<float>(position - knot);
  }
}

void ScanMotion::set_motion(const Vector6& twist, const Vector6& acceleration, double middle) {
  if (still_) return;
  for (int k = 0; k <= kKnots; ++k) {
    const double t = knot_time(k);
    const Pose pose = se3_exp(t * twist + bend_at(t, middle) * acceleration);
    const std::size_t at = static_cast<std::size_t>(k);
    poses_[at] = pose;
    rotations_[at] = pose.linear().cast<float>();
    translations_[at] = pose.translation().cast<float>();
  }
}

}  // namespace scanlock
