// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace scanlock {

/// A levelled rigid motion, source to target: (x, y) turns by `theta` counter-clockwise and moves by (x, y),
/// z moves by z.
struct LevelPose {
  double theta = 0;            ///< radians
  double x = 0, y = 0, z = 0;  ///< metres
};

/// The matches as the solver sees them: z up, horizontal coordinates about the centres of either side, sorted
/// by dz = q_z - p_z. Heights enter only as dz, for the vertical residual of a match is t_z - dz.
struct LevelMatches {
  std::vector<double> px, py, qx, qy, dz;  ///< metres
  std::vector<double> threshold;           ///< metres: largest residual of an inlier, match by match
  std::vector<std::uint32_t> original;     ///< index in the caller's match set
  double largest_threshold = 0;            ///< metres
  double rounding = 0;  ///< metres: how far rounding may move a residual, see counting_limit()

  std::size_t size() const { return dz.size(); }
  void reserve(std::size_t n);
  void push_back_from(const LevelMatches& other, std::size_t i);
};

/// Sorts by dz and sets `largest_threshold` and `rounding`.
LevelMatches sorted_by_height(const LevelMatches& matches);

/// The given subset (ascending), thus sorted too.
LevelMatches select(const LevelMatches& matches, const std::vector<std::uint32_t>& subset);

/// [first, last) of the matches with dz in [low, high].
std::pair<std::size_t, std::size_t> height_range(const LevelMatches& matches, double low, double high);

/// Counts of inliers allow a little more than the threshold, and bounds half of that, so that what touches in
/// exact arithmetic is found in floating point and the search ends: one part in 1e9 of the threshold, and
/// some ulps of the coordinates. A certificate therefore reads: no pose has more than `upper_bound` matches
/// within the threshold, and this pose has that many within (1 + 1e-9) of it.
inline constexpr double kRelativeTolerance = 1e-9;
inline double counting_limit(const LevelMatches& m, std::size_t i) {
  return m.threshold[i] * (1 + kRelativeTolerance) + 2 * m.rounding;
}
inline double bounding_limit(const LevelMatches& m, std::size_t i) {
  return m.threshold[i] * (1 + 0.5 * kRelativeTolerance) + m.rounding;
}

/// The inliers of a pose, ascending: |R p + t - q| <= threshold, Euclidean (equation 3).
std::vector<std::uint32_t> inliers(const LevelMatches& matches, const LevelPose& pose);
int consensus(const LevelMatches& matches, const LevelPose& pose);

/// The least-squares pose of a subset (not empty), and of `size` matches with weights.
LevelPose fit(const LevelMatches& matches, const std::vector<std::uint32_t>& subset);
LevelPose fit(const LevelMatches& matches, const std::uint32_t* subset, const double* weights,
              std::size_t size);

/// The best pose known and its count.
struct Incumbent {
  LevelPose pose;
  int consensus = 0;
};

/// Climbs from a subset: fits to it, then to the inliers of the fit, as long as their number grows. Raises
/// the incumbent if it can.
void climb(const LevelMatches& matches, std::vector<std::uint32_t> subset, Incumbent& best);

}  // namespace scanlock
