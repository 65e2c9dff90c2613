// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace scanlock {

/// The angles from `start` to start + width, counter-clockwise, both ends included. start in [0, 2 pi), width
/// in [0, 2 pi); a whole turn is AngleReach::kAlways instead.
struct AngleInterval {
  double start = 0, width = 0;  ///< radians
};

/// The angles of a rotation about the origin that hold a match: none, all or an interval (Algorithm 4).
enum class AngleReach { kNever, kAlways, kInterval };

/// The angles theta for which |R(theta) p - q| <= e in the plane, given the lengths (metres) and azimuths
/// (radians) of p and q, and e >= 0 (metres). Rounding only widens the interval, by some ulps of the lengths,
/// so that bounds from intervals hold in floating point; a point on the axis gives kAlways or kNever. Half
/// the width has the cosine (|p|^2 + |q|^2 - e^2) / (2 |p| |q|): the paper prints e instead of its square.
AngleReach reach_of(double p_length, double p_azimuth, double q_length, double q_azimuth, double e,
                    AngleInterval& interval);

/// Finds an angle inside as many closed intervals as possible (Algorithm 5), in O(n log n).
/// The object keeps its memory between calls.
class AngleStabber {
 public:
  void clear() { intervals_.clear(); }
  void add(const AngleInterval& interval) { intervals_.push_back(interval); }

  /// Returns the largest number of intervals with a common angle, and sets `theta` to the middle of the first
  /// range of angles where it is attained; to `fallback` if there are no intervals. Radians.
  int stab(double& theta, double fallback = 0);

 private:
  struct Event {
    double angle;
    int step;  // +1 start, -1 end
  };
  std::vector<AngleInterval> intervals_;
  std::vector<Event> events_;
};

}  // namespace scanlock
