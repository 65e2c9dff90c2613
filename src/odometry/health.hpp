// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace scanlock {

/// Whether a source point lies on its surface: nearer than 3 `scale`. `distance`: see ScanAligner; both in
/// metres.
inline bool is_inlier(float distance, double scale) {
  return std::abs(static_cast<double>(distance)) < 3 * scale;
}

/// How well an alignment explains its scan, compared with recent alignments.
struct Health {
  double energy = 1;    ///< weighted mean of Welsch's function of the residuals at a fixed scale, 0 to 1
  double overlap = 0;   ///< share of the source points that met a surface
  double baseline = 0;  ///< running median of the energy, over the history
  bool short_history = true;  ///< history length below five: the map is thin
  /// Energy less baseline, in robust standard deviations of the history, or in units of `chance` (see assess)
  /// where that is larger.
  double score = 0;
  int inliers = 0;                 ///< number of source points with is_inlier()
  double inlier_ratio = 0;         ///< inliers over source points
  double median_inlier_ratio = 0;  ///< running median; 0 without a history
};

/// Standard deviation, by chance, of the energy of a whole scan of a planar sensor with this many points.
double planar_chance(std::size_t points);

/// The normalised energy and its recent history. At a mapped place the energy of a scan is about that of the
/// scans before it, at any speed; at another place it is larger, at whatever pose ICP has converged to. (A
/// bound in metres fails on fast roads, and the overlap alone may be too high at a wrong pose and too low at
/// the right one.)
class HealthMonitor {
 public:
  /// Residuals, distances and weights of source points: see ScanAligner. `scale`: metres, about constant for
  /// one sensor and scene. `chance`: standard deviation of the energy by chance, of a whole scan also where
  /// the points are a part of one.
  Health assess(const std::vector<float>& residuals, const std::vector<float>& distances,
                const std::vector<float>& weights, double scale, double chance) const;
  /// Adds the energy and the inlier ratio of a trusted alignment to the history.
  void remember(const Health& health);
  void forget() { count_ = 0; }
  bool has_history() const { return count_ > 0; }

  /// History length, scans. Odometer smooths the scale of residuals over as many scans, so that it is about
  /// the same for all of them. A longer history would report a slow change of the scene, as on the way into a
  /// wood, as a jump.
  static constexpr std::size_t kHistory = 10;

 private:
  static constexpr std::size_t kShortHistory = 5;             // scans
  std::array<double, kHistory> history_{}, inlier_ratios_{};  ///< energies and inlier ratios, in ring buffers
  std::size_t count_ = 0;  ///< number of remember() since the last forget()
};

}  // namespace scanlock
