// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#include "global/pose_polish.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/elementary.hpp"
#include "global/bounds/angle_stabbing.hpp"

namespace scanlock {
namespace {

class Polisher {
 public:
  Polisher(const LevelMatches& matches, const LevelPose& start) : m_(matches), pose_(start) {
    constexpr double kWithin = 2;  // thresholds
    const auto [s, c] = sincos(start.theta);
    const double reach = kWithin * m_.largest_threshold;
    const auto [first, last] = height_range(m_, start.z - reach, start.z + reach);
    for (std::size_t i = first; i < last; ++i) {
      const double x = m_.qx[i] - (c * m_.px[i] - s * m_.py[i]) - start.x;
      const double y = m_.qy[i] - (s * m_.px[i] + c * m_.py[i]) - start.y;
      if (x * x + y * y <= reach * reach) near_.push_back(i);
    }
  }

  LevelPose run() {
    constexpr int kPolishRounds = 6;
    for (int round = 0, best = 0; round < kPolishRounds; ++round) {
      int count = 0;
      turn();
      for (int axis = 0; axis < 3; ++axis) count = shift(axis);
      if (count <= best && round > 1) break;
      best = std::max(best, count);
    }
    return pose_;
  }

 private:
  void turn() {
    stabber_.clear();
    int always = 0;
    for (const std::size_t i : near_) {
      const double limit = counting_limit(m_, i), dz = pose_.z - m_.dz[i], square = limit * limit - dz * dz;
      if (square < 0) continue;
      const double x = m_.qx[i] - pose_.x, y = m_.qy[i] - pose_.y;
      AngleInterval interval;
      switch (reach_of(hypot(m_.px[i], m_.py[i]), atan2(m_.py[i], m_.px[i]), hypot(x, y), atan2(y, x),
                       std::sqrt(square), interval)) {
        case AngleReach::kNever:
          break;
        case AngleReach::kAlways:
          ++always;
          break;
        case AngleReach::kInterval:
          stabber_.add(interval);
          break;
      }
    }
    stabber_.stab(pose_.theta, pose_.theta);
  }

  /// Stabs the translations along one axis; returns the number of matches held.
  int shift(int axis) {
    const auto [s, c] = sincos(pose_.theta);
    double LevelPose::*const axes[] = {&LevelPose::x, &LevelPose::y, &LevelPose::z};
    events_.clear();
    for (const std::size_t i : near_) {
      const double t[] = {m_.qx[i] - (c * m_.px[i] - s * m_.py[i]), m_.qy[i] - (s * m_.px[i] + c * m_.py[i]),
                          m_.dz[i]};
      const double limit = counting_limit(m_, i);
      double square = limit * limit;
      for (int other = 0; other < 3; ++other) {
        const double gap = t[other] - pose_.*axes[other];
        if (other != axis) square -= gap * gap;
      }
      if (square < 0) continue;
      events_.push_back({t[axis] - std::sqrt(square), -1});
      events_.push_back({t[axis] + std::sqrt(square), +1});
    }
    std::sort(events_.begin(), events_.end());  // starts before ends: touching intervals share their end
    int depth = 0, most = 0;
    for (std::size_t k = 0; k + 1 < events_.size(); ++k) {
      depth -= events_[k].second;
      if (depth <= most) continue;
      most = depth;
      pose_.*axes[axis] = 0.5 * (events_[k].first + events_[k + 1].first);
    }
    return most;
  }

  const LevelMatches& m_;
  LevelPose pose_;
  std::vector<std::size_t> near_;
  std::vector<std::pair<double, int>> events_;
  AngleStabber stabber_;
};

}  // namespace

void polish(const LevelMatches& matches, Incumbent& best) {
  const LevelPose pose = Polisher(matches, best.pose).run();
  const int count = consensus(matches, pose);
  if (count > best.consensus) best = {pose, count};
}

}  // namespace scanlock
