// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace scanlock {

/// A levelled rigid motion, source to target: a rotation about z by `theta`, counter-clockwise, and a
/// translation by (x, y, z).
struct LevelPose {
  double theta = 0;            ///< radians
  double x = 0, y = 0, z = 0;  ///< metres
};

/// The matches in the solver's coordinates: z up, source and target points relative to their centres, sorted
/// by dz = q_z - p_z. Heights are stored only as dz, because the vertical residual of a match is t_z - dz.
struct LevelMatches {
  std::vector<double> px, py, qx, qy, dz;  ///< metres
  std::vector<double> threshold;           ///< metres: largest residual of an inlier, match by match
  std::vector<std::uint32_t> original;     ///< index in the caller's match set
  double largest_threshold = 0;            ///< metres
  double rounding = 0;  ///< metres: bound of the rounding error of a residual, see counting_limit()

  std::size_t size() const { return dz.size(); }
  void reserve(std::size_t n);
  void push_back_from(const LevelMatches& other, std::size_t i);
};

/// Sorts by dz and sets `largest_threshold` and `rounding`.
LevelMatches sorted_by_height(const LevelMatches& matches);

/// The matches of `subset` (ascending indices), which are therefore sorted, too.
LevelMatches select(const LevelMatches& matches, const std::vector<std::uint32_t>& subset);

/// The range [first, last) of the matches with dz in [low, high], metres.
std::pair<std::size_t, std::size_t> height_range(const LevelMatches& matches, double low, double high);

/// Counts of inliers use a limit slightly above the threshold, and bounds half of that margin, so that
/// matches whose residual equals the threshold in exact arithmetic are found in floating point, and the
/// search ends. The margin is one part in 1e9 of the threshold and some ulps of the coordinates. The meaning
/// of a certificate is therefore: no pose has more than `upper_bound` matches within the threshold, and this
/// pose has that many within (1 + 1e-9) thresholds.
inline constexpr double kRelativeTolerance = 1e-9;
inline double counting_limit(const LevelMatches& m, std::size_t i) {
  return m.threshold[i] * (1 + kRelativeTolerance) + 2 * m.rounding;
}
inline double bounding_limit(const LevelMatches& m, std::size_t i) {
  return m.threshold[i] * (1 + 0.5 * kRelativeTolerance) + m.rounding;
}

/// The inliers of a pose, ascending: |R p + t - q| <= threshold, Euclidean (equation 3). consensus() is their
/// number.
std::vector<std::uint32_t> inliers(const LevelMatches& matches, const LevelPose& pose);
int consensus(const LevelMatches& matches, const LevelPose& pose);

/// The least-squares pose of a subset (not empty), and that of `size` weighted matches.
LevelPose fit(const LevelMatches& matches, const std::vector<std::uint32_t>& subset);
LevelPose fit(const LevelMatches& matches, const std::uint32_t* subset, const double* weights,
              std::size_t size);

/// The best pose known and its number of inliers.
struct Incumbent {
  LevelPose pose;
  int consensus = 0;
};

/// Fits a pose to a subset, then to the inliers of that pose, as long as their number grows. Raises the
/// incumbent if a pose has more inliers.
void climb(const LevelMatches& matches, std::vector<std::uint32_t> subset, Incumbent& best);

}  // namespace scanlock
