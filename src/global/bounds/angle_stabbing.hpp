// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace scanlock {

/// The angles from `start` on, counter-clockwise, through `width`, both ends included. start in [0, 2 pi),
/// width in [0, 2 pi); a whole turn is not an interval, for it decides nothing.
struct AngleInterval {
  double start = 0, width = 0;  ///< radians
};

/// How a match constrains the angle of a rotation about the origin (Algorithm 4).
enum class AngleReach { kNever, kAlways, kInterval };

/// The angles theta for which |R(theta) p - q| <= e in the plane, given the lengths and azimuths of p and q
/// and e >= 0. Errs only outwards, by some ulps of the lengths, so that bounds made of intervals hold in
/// floating point; a point on the axis gives kAlways or kNever. The cosine is (|p|^2 + |q|^2 - e^2) / (2 |p|
/// |q|): the paper prints e for its square.
AngleReach reach_of(double p_length, double p_azimuth, double q_length, double q_azimuth, double e,
                    AngleInterval& interval);

/// Finds an angle inside as many closed intervals as possible (Algorithm 5), in O(n log n).
/// The object keeps its memory from call to call.
class AngleStabber {
 public:
  void clear() { intervals_.clear(); }
  void add(const AngleInterval& interval) { intervals_.push_back(interval); }

  /// The largest number of intervals with a common angle, and the middle of the first stretch where it is
  /// attained. `fallback` is returned as the angle when there are no intervals.
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
