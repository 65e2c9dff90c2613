// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/bounds/angle_stabbing.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/elementary.hpp"

namespace scanlock {
namespace {

constexpr double kTurn = 2 * kPi;
constexpr double kUlps = 32 * 2.2e-16;    // of the squared lengths
constexpr double kAngleRounding = 4e-15;  // radians: of two azimuths, an arc cosine and their sums

double wrapped(double angle) {
  angle -= kTurn * std::floor(angle / kTurn);
  return angle < kTurn ? std::max(angle, 0.0) : 0.0;
}

}  // namespace

AngleReach reach_of(double p_length, double p_azimuth, double q_length, double q_azimuth, double e,
                    AngleInterval& interval) {
  const double squares = p_length * p_length + q_length * q_length;
  const double product = 2 * p_length * q_length;
  const double cosine_times_product = squares - e * e - kUlps * squares;
  if (cosine_times_product <= -product) return AngleReach::kAlways;
  if (cosine_times_product > product) return AngleReach::kNever;
  const double gamma = acos(std::clamp(cosine_times_product / product, -1.0, 1.0)) + kAngleRounding;
  if (gamma >= kPi) return AngleReach::kAlways;
  interval.start = wrapped(q_azimuth - p_azimuth - gamma);
  interval.width = 2 * gamma;
  return AngleReach::kInterval;
}

int AngleStabber::stab(double& theta, double fallback) {
  theta = fallback;
  if (intervals_.empty()) return 0;
  events_.clear();
  int depth = 0;
  for (const AngleInterval& interval : intervals_) {
    double end = interval.start + interval.width;
    if (end >= kTurn) {  // the interval contains angle 0
      end -= kTurn;
      ++depth;
    }
    events_.push_back({interval.start, +1});
    events_.push_back({end, -1});
  }
  std::sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) {
    return a.angle != b.angle ? a.angle < b.angle
                              : a.step > b.step;  // touching closed intervals share their end
  });
  int best = depth;
  double from = 0, to = events_.front().angle;
  for (std::size_t i = 0; i < events_.size(); ++i) {
    depth += events_[i].step;
    if (depth > best) {
      best = depth;
      from = events_[i].angle;
      to = i + 1 < events_.size() ? events_[i + 1].angle : kTurn;
    }
  }
  theta = 0.5 * (from + to);
  return best;
}

}  // namespace scanlock
