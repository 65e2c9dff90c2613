// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
//
// Algorithms 4 and 5 of Practical optimal registration of terrestrial LiDAR scan pairs (Cai, Chin, Parra
// Bustos, Schindler) as they are printed. Corrections of the print are marked.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/match.hpp"

namespace scanlock::reference {

using Interval = std::pair<double, double>;  // [alpha, beta]

/// Algorithm 4, and nothing where its requirement d_i <= epsilon (equation 28) does not hold. Correction: the
/// print writes R(theta) of equation 2 clockwise, but the azimuths here make it counter-clockwise.
inline std::optional<Interval> angle_interval(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                                              double epsilon) {
  const double p_xy = p.head<2>().norm(), q_xy = q.head<2>().norm();
  if (std::sqrt((p_xy - q_xy) * (p_xy - q_xy) + (p.z() - q.z()) * (p.z() - q.z())) > epsilon) return {};
  const double e_xy = std::sqrt(epsilon * epsilon - (p.z() - q.z()) * (p.z() - q.z()));  // line 1
  if (p_xy + q_xy <= e_xy) return Interval(0, 2 * kPi);                                  // 2, 3
  const double omega = std::atan2(q.y(), q.x()) - std::atan2(p.y(), p.x());              // 5
  // Correction: the print has epsilon_xy; the law of cosines takes its square.
  const double cosine = (p_xy * p_xy + q_xy * q_xy - e_xy * e_xy) / (2 * p_xy * q_xy);
  const double gamma = std::acos(std::min(std::max(cosine, -1.0), 1.0));
  return Interval(omega - gamma, omega + gamma);  // 6
}

/// By section 4.1: an interval that extends beyond [0, 2 pi] is split in two, and where an interval has an
/// end at 0 or 2 pi, which are the same angle, the other of the two is added (figure 5).
inline std::vector<Interval> within_a_turn(Interval interval) {
  const double width = interval.second - interval.first;
  double start = std::fmod(interval.first, 2 * kPi);
  if (start < 0) start += 2 * kPi;
  if (width >= 2 * kPi) return {{0, 2 * kPi}};
  if (start + width > 2 * kPi) return {{0, start + width - 2 * kPi}, {start, 2 * kPi}};
  if (start + width == 2 * kPi) return {{0, 0}, {start, 2 * kPi}};
  if (start == 0) return {{0, width}, {2 * kPi, 2 * kPi}};
  return {{start, start + width}};
}

struct Stabbing {
  int depth = 0;
  double theta = 0;
};

/// Algorithm 5, for intervals within [0, 2 pi].
inline Stabbing max_stabbing(const std::vector<Interval>& intervals) {
  std::vector<std::pair<double, int>> v;  // line 1
  for (const Interval& interval : intervals) {
    v.push_back({interval.first, 0});
    v.push_back({interval.second, 1});
  }
  std::sort(v.begin(), v.end());  // a1, a2
  Stabbing best;                  // 2
  int delta = 0;
  for (const auto& end : v) {  // 3
    if (end.second == 0) {     // 4
      ++delta;                 // 5
      if (delta > best.depth) best = {delta, end.first};
    } else {
      --delta;  // 7
    }
  }
  return best;  // 10
}

/// U(t | C, epsilon), equations 7 and 11, with its angle.
inline Stabbing best_angle(const Matches& matches, const Eigen::Vector3d& t, double epsilon) {
  std::vector<Interval> intervals;
  for (const Match& match : matches) {
    if (const auto interval = angle_interval(match.p, match.q - t, epsilon)) {
      for (const Interval& part : within_a_turn(*interval)) intervals.push_back(part);
    }
  }
  return max_stabbing(intervals);
}

}  // namespace scanlock::reference
