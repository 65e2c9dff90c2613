// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace scanlock {

/// Of a source point, by its distance (see ScanAligner) from the surface that it met; both in metres.
inline bool is_inlier(float distance, double scale) {
  return std::abs(static_cast<double>(distance)) < 3 * scale;
}

/// How well an alignment explains its scan, compared with recent alignments.
struct Health {
  double energy = 1;    ///< weighted mean of Welsch's function of the residuals at a fixed scale, 0 to 1
  double overlap = 0;   ///< share of the source points that met a surface
  double baseline = 0;  ///< median of the recent energies
  bool young = true;    ///< there are fewer than five of them: the map is thin
  double rise = 0;      ///< of the energy over the baseline, in robust standard deviations of the recent ones
  double score = 0;     ///< z-score: the same, in units of `chance` (see assess) where that is larger
  int inliers = 0;      ///< source points, see is_inlier()
  double share = 0;     ///< of the source points, the inliers
  double usual_share = 0;  ///< median of the recent ones
};

/// Standard deviation, by chance, of the energy of a whole scan of a planar sensor.
double planar_chance(std::size_t points);

/// The normalised energy and its recent history. At a known place the energy of a scan is about that of the
/// scans before it, at any speed; at another place, wherever ICP has slid it, it is larger. (A guard in
/// metres fails on fast roads, and overlap alone lies in both directions.)
class HealthMonitor {
 public:
  /// Residuals, distances and weights of source points: see ScanAligner. `scale`: metres, fixed while the
  /// sensor and the scene stay what they are. `chance`: standard deviation of the energy of a whole scan by
  /// chance; the scan here may be a part of it.
  Health assess(const std::vector<float>& residuals, const std::vector<float>& distances,
                const std::vector<float>& weights, double scale, double chance) const;
  /// Adds the energy of an alignment that was trusted.
  void remember(const Health& health);
  void forget() { count_ = 0; }
  bool has_history() const { return count_ > 0; }

  /// Scans that are remembered: those since which the scale of residuals is about the same, for Odometer
  /// smooths it over as many. A longer memory takes a slow change of the scene, as of a wood that a robot
  /// drives into, for a jump.
  static constexpr std::size_t kHistory = 10;

 private:
  static constexpr std::size_t kYoung = 5;  // scans
  std::array<double, kHistory> history_{}, shares_{};
  std::size_t count_ = 0;  ///< remembered since the last forget
};

}  // namespace scanlock
